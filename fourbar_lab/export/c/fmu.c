/* FMI 2.0: all state is in one struct without pointers. */
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

EXPORT void fmi2FreeInstance(Instance instance) { free(instance); }
PLAIN(fmi2ExitInitializationMode)
PLAIN(fmi2Terminate)
PLAIN(fmi2EnterEventMode)
PLAIN(fmi2EnterContinuousTimeMode)
EXPORT Status fmi2Reset(Instance instance) { reset(STATE); return OK; }
EXPORT Status fmi2SetTime(Instance instance, double time) { STATE->time = time; return OK; }

EXPORT Status fmi2SetDebugLogging(Instance instance, int on, size_t count, const Text *which)
{
  (void)instance; (void)on; (void)count; (void)which;
  return OK;
}

/* A copy of the whole state, kept by the master; `to` is made if it is not there. */
EXPORT Status fmi2GetFMUstate(Instance instance, void **to)
{
  if (*to == NULL) *to = malloc(sizeof(State));
  if (*to == NULL) return ERROR;
  memcpy(*to, instance, sizeof(State));
  return OK;
}

EXPORT Status fmi2SetFMUstate(Instance instance, void *from)
{
  memcpy(instance, from, sizeof(State));
  return OK;
}

EXPORT Status fmi2FreeFMUstate(Instance instance, void **kept)
{
  (void)instance;
  free(*kept);
  *kept = NULL;
  return OK;
}

EXPORT Status fmi2CompletedIntegratorStep(Instance instance, int is_final, int *enters_event,
                                          int *terminates)
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

STATES(fmi2SetContinuousStates, const double *)
STATES(fmi2GetEventIndicators, double *)
STATES(fmi2GetContinuousStates, double *)
STATES(fmi2GetNominalsOfContinuousStates, double *)

EXPORT Text fmi2GetTypesPlatform(void);
EXPORT Text fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Text fmi2GetVersion(void);
EXPORT Text fmi2GetVersion(void) { return "2.0"; }

EXPORT Instance fmi2Instantiate(Text name, int type, Text guid, Text resources,
                                const void *callbacks, int visible, int logs)
{
  (void)name; (void)resources; (void)callbacks; (void)visible; (void)logs;
  return type == 1 || EXCHANGES ? new_instance(guid) : NULL;
}

EXPORT Status fmi2SetupExperiment(Instance instance, int with_tolerance, double tolerance,
                                  double start, int with_end, double end)
{
  (void)with_tolerance; (void)tolerance; (void)with_end; (void)end;
  STATE->time = start;
  return OK;
}

PLAIN(fmi2EnterInitializationMode)

EXPORT Status fmi2GetReal(Instance instance, const unsigned *which, size_t count, double *to)
{
  return get_numbers(STATE, which, count, to);
}

EXPORT Status fmi2SetReal(Instance instance, const unsigned *which, size_t count,
                          const double *from)
{
  return set_numbers(STATE, which, count, from);
}

EXPORT Status fmi2DoStep(Instance instance, double time, double step, int is_final)
{
  (void)is_final;
  return do_step(STATE, time, step);
}

typedef struct {
  int new_states_needed, terminate, nominals_changed, values_changed, has_next_time;
  double next_time;
} EventInfo;

EXPORT Status fmi2NewDiscreteStates(Instance instance, EventInfo *to)
{
  (void)instance;
  memset(to, 0, sizeof *to);
  return OK;
}

STATES(fmi2GetDerivatives, double *)

/* Every number is real; the functions must be there all the same. */
#define NONE(name) \
  EXPORT Status name(Instance instance, const unsigned *which, size_t count, const void *values) \
  { (void)instance; (void)which; (void)values; return count == 0 ? OK : ERROR; }
