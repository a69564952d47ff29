// --- header
ABOUT
#ifndef FOURBAR_GUARD_H
#define FOURBAR_GUARD_H

#ifdef __cplusplus
extern "C" {
#endif

/* As in the node: a sample out of range has no pose, all but the input is NaN; invalid
   input is not finite, or so fast that a result overflows; at a toggle rates are unbounded,
   NaN, the pose is valid; where the rate or acceleration is NaN, all that depends on it is. Loads
   are NaN unless ok. With a length of 0 or less, a negative mass or inertia, no status is ok. */
typedef enum {
STATUS
} NAME_status;

RECORDS
/* What follows from parameters alone; NAME_prepare makes it. */
typedef struct { double k[KEPT]; } NAME_constants;

/* Parameters of the scene. */
void NAME_defaults(NAME_parameters *to);
/* Once, and after each change of a parameter. */
void NAME_prepare(const NAME_parameters *from, NAME_constants *made);
/* The motion. */
MOTION_AT;
OF_BOTHSET_MODE/* Return how many results differ in any bit from those of Python: 0. */
int NAME_self_check(void);

DRIVE#ifdef __cplusplus
}
#endif
#endif
// --- header_of_loads
/* Motion and loads. */
STEP;
// --- header_of_modes
/* Take an assembly mode, as of a drive that has passed a toggle. */
void NAME_set_mode(NAME_parameters *to, double mode);
// --- source
ABOUT
#ifdef __FAST_MATH__
#error "-ffast-math changes the results"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize ("fp-contract=off", "no-tree-slp-vectorize")
#endif
#include "NAME.h"
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

RUNTIMEvoid NAME_defaults(NAME_parameters *to)
{
DEFAULTS}

void NAME_prepare(const NAME_parameters *from, NAME_constants *made)
{
PREPARATION}

FUNCTIONS
// --- set_mode
void NAME_set_mode(NAME_parameters *to, double mode)
{
SIGNS}
// --- function
static int WHICH_of(const double *k, double x0, double x1, double x2, double *values,
    double *closes, double *condition)
{
  int refused = 0;
  (void)k;
  (void)x0;
  (void)x1;
  (void)x2;
STATEMENTS  return refused;
}

SIGNATURE
{
  double values[RESULTS];
  const double x0 = input->X0, x1 = input->X1, x2 = input->X2;
  double closes = NAN, condition = NAN;
  int status = first_look(x0OVERFLOWING, x1, x2);
  if (status != INVALID_INPUT) {
    const int refused = WHICH_of(with->k, x0, x1, x2, values, &closes, &condition);
    status = judged(status, refused, closes, condition, x0, values, LOADS);
  }
  if (status != 0) without_answer(status, x1, x2, values, LOADS);
  if (status == 1 || status == 2) {
INPUTS  }
  memcpy(motion, values, sizeof *motion);
COPY  return (NAME_status)status;
}
// --- self_check
int NAME_self_check(void)
{
EXPECTED  NAME_parameters parameters;
  NAME_constants constants;
  NAME_input input;
RESULTS  int differ = 0;
INPUTS  NAME_defaults(&parameters);
  NAME_prepare(&parameters, &constants);
  (void)NAME_CALL(&constants, &input, &POINTERS);
COMPARED  return differ;
}
