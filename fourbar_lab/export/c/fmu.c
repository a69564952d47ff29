/* What both versions of FMI share: all state is in one struct without pointers. */
#include <stdlib.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
  NAME_input input;
  NAME_parameters parameters;
  NAME_motion motion;
LOADS_FIELD
DRIVE_FIELD
  NAME_constants constants;
  double status, time;
  int constants_are_old, results_are_old;
} State;

enum { GIVEN = INPUTS + PARAMETERS, RESULTS = GIVEN + MOTIONS + LOADS, STATUS = RESULTS,
       TIME = RESULTS + 1DRIVE_NUMBERS, NUMBERS };

static void reset(State *state)
{
  memset(state, 0, sizeof *state);
  NAME_defaults(&state->parameters);
  STARTS
  state->constants_are_old = state->results_are_old = 1;
}

/* The number of a value reference. */
static void *number(State *state, unsigned reference)
{
  if (reference < INPUTS) return (char *)&state->input + reference * sizeof(double);
  if (reference < GIVEN)
    return (char *)&state->parameters + (reference - INPUTS) * sizeof(double);
  if (reference < GIVEN + MOTIONS)
    return (char *)&state->motion + (reference - GIVEN) * sizeof(double);
LOADS_NUMBER
DRIVE_NUMBER
  return reference == STATUS ? &state->status : &state->time;
}

static int get_numbers(State *state, const unsigned *references, size_t count, double *to)
{
  size_t i;
  for (i = 0; i < count; ++i) {
    if (references[i] >= NUMBERS) return 3;
    if (references[i] >= GIVEN && references[i] <= STATUS && state->results_are_old) {
      INPUT_OF_DRIVE
      if (state->constants_are_old) NAME_prepare(&state->parameters, &state->constants);
      state->status = (double)STEP;
      state->constants_are_old = state->results_are_old = 0;
    }
    memcpy(to + i, number(state, references[i]), sizeof *to);
  }
  return 0;
}

static int set_numbers(State *state, const unsigned *references, size_t count,
                       const double *from)
{
  size_t i;
  for (i = 0; i < count; ++i) {
    SET_COMMAND
    if (references[i] >= GIVEN) return 3;
    memcpy(number(state, references[i]), from + i, sizeof *from);
    if (references[i] >= INPUTS) state->constants_are_old = 1;
    state->results_are_old = 1;
  }
  return 0;
}

DERIVATIVES_OF
static int derivatives(State *state, const unsigned *of, size_t many, const unsigned *by,
                       size_t count, const double *along, double *to)
{
DERIVATIVES
}

/* Model exchange: the inputs determine everything, so there are no states and no events. */
#define STATES(name, type) \
  EXPORT int name(void *instance, type values, size_t count) \
  { (void)instance; (void)values; return count == 0 ? 0 : 3; }

/* Copies of the whole state, kept by the master; `to` is made if it is not there. */
static int copy_state(const void *from, void **to)
{
  if (*to == NULL) *to = malloc(sizeof(State));
  if (*to == NULL) return 3;
  memcpy(*to, from, sizeof(State));
  return 0;
}

static int free_state(void **kept)
{
  free(*kept);
  *kept = NULL;
  return 0;
}

static int write_state(const void *kept, void *to, size_t size)
{
  if (size < sizeof(State)) return 3;
  memcpy(to, kept, sizeof(State));
  return 0;
}
// --- number
  if (reference == TORQUE) return &COMMAND;
  if (reference == DRIVE_STATUS) return &state->drive_status;
  if (reference >= DRIVE) return (char *)&state->drive + (reference - DRIVE) * sizeof(double);
// --- command
    if (references[i] == TORQUE) {
      COMMAND = from[i];
      if (!state->has_moved) BEGIN;
      state->results_are_old = 1;
      continue;
    }
// --- advance
  if (step > 0.0) {
    State *state = STATE;
    state->drive_status = (double)NAME_advance(&state->drive, step GIVEN_TORQUE);
    state->has_moved = state->results_are_old = 1;
  }
// --- derivatives
  const unsigned all = STATUS;
  double x[2 * GIVEN], status, found[MOTIONS + LOADS];     /* x: what is given, the direction */
  size_t i;
  memset(x, 0, sizeof x);
  memcpy(x, &state->input, INPUTS * sizeof *x);
  memcpy(x + INPUTS, &state->parameters, PARAMETERS * sizeof *x);
  for (i = 0; i < count; ++i) {
    if (by[i] >= GIVEN) return 3;
    x[GIVEN + by[i]] += along[i];
  }
  (void)get_numbers(state, &all, 1, &status);
  derivatives_of(x, found);
  for (i = 0; i < many; ++i) {
    if (of[i] < GIVEN || of[i] > STATUS) return 3;
    to[i] = of[i] == STATUS ? 0.0 : status > 0.0 ? NAN : found[of[i] - GIVEN];
  }
  return 0;
// --- no_derivatives
  (void)state; (void)of; (void)many; (void)by; (void)count; (void)along; (void)to;
  return 3;
// --- mode
      if (state->mode < state->drive.mode || state->mode > state->drive.mode) {
        state->mode = state->drive.mode;
        NAME_set_mode(&state->parameters, state->mode);
        state->constants_are_old = 1;
      }
