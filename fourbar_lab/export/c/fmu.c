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
#if LOADS
  NAME_loads loads;
#endif
#if HAS_DRIVE
  NAME_drive drive;
  double drive_status, torque, mode;
  int has_moved;
#endif
  NAME_constants constants;
  double status, time;
  int constants_are_old, results_are_old;
} State;

enum { GIVEN = INPUTS + PARAMETERS, RESULTS = GIVEN + MOTIONS + LOADS, STATUS = RESULTS,
       TIME = RESULTS + 1,
#if HAS_DRIVE
       DRIVE, DRIVE_STATUS = DRIVE + DRIVE_NUMBERS, TORQUE,
#endif
       NUMBERS, EXCHANGES = !HAS_DRIVE };

typedef void *Instance;
typedef const char *Text;
typedef int Status;
enum { OK = 0, ERROR = 3 };
#define STATE ((State *)instance)

static void reset(State *state)
{
  memset(state, 0, sizeof *state);
  NAME_defaults(&state->parameters);
#if HAS_DRIVE
  NAME_start(&state->drive GIVEN_TORQUE);
#else
  *(double *)&state->input = START;
#endif
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
#if LOADS
  if (reference < RESULTS)
    return (char *)&state->loads + (reference - GIVEN - MOTIONS) * sizeof(double);
#endif
#if HAS_DRIVE
  if (reference == TORQUE) return &COMMAND;
  if (reference == DRIVE_STATUS) return &state->drive_status;
  if (reference >= DRIVE) return (char *)&state->drive + (reference - DRIVE) * sizeof(double);
#endif
  return reference == STATUS ? &state->status : &state->time;
}

static void compute(State *state)
{
#if HAS_DRIVE
  const double input[INPUTS] = {state->drive.position, state->drive.velocity,
                                state->drive.acceleration};
  memcpy(&state->input, input, sizeof input);
#endif
#if HAS_MODES
  if (state->mode < state->drive.mode || state->mode > state->drive.mode) {
    state->mode = state->drive.mode;
    NAME_set_mode(&state->parameters, state->mode);
    state->constants_are_old = 1;
  }
#endif
  if (state->constants_are_old) NAME_prepare(&state->parameters, &state->constants);
#if LOADS
  state->status = (double)NAME_step(&state->constants, &state->input, &state->motion,
                                    &state->loads);
#else
  state->status = (double)NAME_motion_at(&state->constants, &state->input, &state->motion);
#endif
  state->constants_are_old = state->results_are_old = 0;
}

static int get_numbers(State *state, const unsigned *references, size_t count, double *to)
{
  size_t i;
  for (i = 0; i < count; ++i) {
    if (references[i] >= NUMBERS) return 3;
    if (references[i] >= GIVEN && references[i] <= STATUS && state->results_are_old)
      compute(state);
    memcpy(to + i, number(state, references[i]), sizeof *to);
  }
  return 0;
}

static int set_numbers(State *state, const unsigned *references, size_t count,
                       const double *from)
{
  size_t i;
  for (i = 0; i < count; ++i) {
#if HAS_COMMAND
    if (references[i] == TORQUE) {
      COMMAND = from[i];
      if (!state->has_moved) BEGIN(&state->drive GIVEN_TORQUE);
      state->results_are_old = 1;
      continue;
    }
#endif
    if (references[i] >= GIVEN) return 3;
    memcpy(number(state, references[i]), from + i, sizeof *from);
    if (references[i] >= INPUTS) state->constants_are_old = 1;
    state->results_are_old = 1;
  }
  return 0;
}

/* Model exchange: the inputs determine everything, so there are no states and no events. */
#define STATES(name, type) \
  EXPORT Status name(Instance instance, type values, size_t count) \
  { (void)instance; (void)values; return count == 0 ? OK : ERROR; }
/* What is offered nowhere: it must be there, and nobody calls it. */
#define REFUSED(name) EXPORT Status name(void) { return ERROR; }
#define PLAIN(name) EXPORT Status name(Instance instance) { (void)instance; return OK; }

/* NULL where description and binary are not of one unit. */
static Instance new_instance(Text token)
{
  State *state = token && strcmp(token, "GUID") == 0 ? (State *)calloc(1, sizeof *state) : NULL;
  if (state) reset(state);
  return state;
}

EXPORT void FMI_FreeInstance(Instance instance) { free(instance); }
PLAIN(FMI_ExitInitializationMode)
PLAIN(FMI_Terminate)
PLAIN(FMI_EnterEventMode)
PLAIN(FMI_EnterContinuousTimeMode)
EXPORT Status FMI_Reset(Instance instance) { reset(STATE); return OK; }
EXPORT Status FMI_SetTime(Instance instance, double time) { STATE->time = time; return OK; }

EXPORT Status FMI_SetDebugLogging(Instance instance, Flag on, size_t count, const Text *which)
{
  (void)instance; (void)on; (void)count; (void)which;
  return OK;
}

/* A copy of the whole state, kept by the master; `to` is made if it is not there. */
EXPORT Status FMI_GetFMUState(Instance instance, void **to)
{
  if (*to == NULL) *to = malloc(sizeof(State));
  if (*to == NULL) return ERROR;
  memcpy(*to, instance, sizeof(State));
  return OK;
}

EXPORT Status FMI_SetFMUState(Instance instance, void *from)
{
  memcpy(instance, from, sizeof(State));
  return OK;
}

EXPORT Status FMI_FreeFMUState(Instance instance, void **kept)
{
  (void)instance;
  free(*kept);
  *kept = NULL;
  return OK;
}

EXPORT Status FMI_CompletedIntegratorStep(Instance instance, Flag is_final, Flag *enters_event,
                                          Flag *terminates)
{
  (void)instance; (void)is_final;
  *enters_event = *terminates = 0;
  return OK;
}

static Status do_step(State *state, double time, double step)
{
  if (!(step >= 0.0 && step < HUGE_VAL)) return ERROR;
#if HAS_DRIVE
  if (step > 0.0) {
    state->drive_status = (double)NAME_advance(&state->drive, step GIVEN_TORQUE);
    state->has_moved = state->results_are_old = 1;
  }
#endif
  state->time = time + step;
  return OK;
}

STATES(FMI_SetContinuousStates, const double *)
STATES(FMI_GetEventIndicators, double *)
STATES(FMI_GetContinuousStates, double *)
STATES(FMI_GetNominalsOfContinuousStates, double *)
