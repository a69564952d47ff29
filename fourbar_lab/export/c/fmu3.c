#include <stdbool.h>

typedef void *Instance;
typedef const char *Text;
typedef int Status;
enum { OK = 0, ERROR = 3 };
#define STATE ((State *)instance)

EXPORT Text fmi3GetVersion(void) { return "3.0"; }

EXPORT Status fmi3SetDebugLogging(Instance instance, bool on, size_t count, const Text *which)
{
  (void)instance; (void)on; (void)count; (void)which;
  return OK;
}

typedef void (*Log)(void *, Status, Text, Text);

static Instance instance_of(Text token, void *environment, Log logger)
{
  State *state;
  if (token == NULL || strcmp(token, "GUID") != 0) {
    if (logger) logger(environment, ERROR, "logStatusError", "NAME: another token");
    return NULL;
  }
  state = (State *)calloc(1, sizeof *state);
  if (state) reset(state);
  return state;
}

EXPORT Instance fmi3InstantiateCoSimulation(
  Text name, Text token, Text resources, bool visible, bool logs, bool events, bool early,
  const unsigned *variables, size_t count, void *environment, Log logger, void *update)
{
  (void)name; (void)resources; (void)visible; (void)logs; (void)events; (void)early;
  (void)variables; (void)count; (void)update;
  return instance_of(token, environment, logger);
}

/* Motion by torque is for co-simulation only. */
EXPORT Instance fmi3InstantiateModelExchange(Text name, Text token, Text resources, bool visible,
                                             bool logs, void *environment, Log logger)
{
  (void)name; (void)resources; (void)visible; (void)logs;
  return EXCHANGES ? instance_of(token, environment, logger) : NULL;
}

EXPORT Instance fmi3InstantiateScheduledExecution(
  Text name, Text token, Text resources, bool visible, bool logs, void *environment,
  void *logger, void *update, void *lock, void *unlock)
{
  (void)name; (void)token; (void)resources; (void)visible; (void)logs; (void)environment;
  (void)logger; (void)update; (void)lock; (void)unlock;
  return NULL;
}

EXPORT void fmi3FreeInstance(Instance instance) { free(instance); }

EXPORT Status fmi3EnterInitializationMode(Instance instance, bool with_tolerance,
                                          double tolerance, double start, bool with_end,
                                          double end)
{
  (void)with_tolerance; (void)tolerance; (void)with_end; (void)end;
  STATE->time = start;
  return OK;
}

EXPORT Status fmi3ExitInitializationMode(Instance instance) { (void)instance; return OK; }
EXPORT Status fmi3Terminate(Instance instance) { (void)instance; return OK; }
EXPORT Status fmi3Reset(Instance instance) { reset(STATE); return OK; }

EXPORT Status fmi3GetFloat64(Instance instance, const unsigned *which, size_t count, double *to,
                             size_t values)
{
  return values != count ? ERROR : get_numbers(STATE, which, count, to);
}

EXPORT Status fmi3SetFloat64(Instance instance, const unsigned *which, size_t count,
                             const double *from, size_t values)
{
  return values != count ? ERROR : set_numbers(STATE, which, count, from);
}

EXPORT Status fmi3DoStep(Instance instance, double time, double step, bool no_way_back,
                         bool *event, bool *terminate, bool *early, double *last)
{
  (void)no_way_back;
  if (!(step >= 0.0 && step < HUGE_VAL)) return ERROR;
  ADVANCE
  STATE->time = time + step;
  *event = *terminate = *early = false;
  *last = STATE->time;
  return OK;
}

EXPORT Status fmi3GetFMUState(Instance instance, void **to)
{
  return copy_state(instance, to);
}

EXPORT Status fmi3SetFMUState(Instance instance, void *from)
{
  memcpy(instance, from, sizeof(State));
  return OK;
}

EXPORT Status fmi3FreeFMUState(Instance instance, void **kept)
{
  (void)instance;
  return free_state(kept);
}

EXPORT Status fmi3SerializedFMUStateSize(Instance instance, void *kept, size_t *size)
{
  (void)instance; (void)kept;
  *size = sizeof(State);
  return OK;
}

EXPORT Status fmi3SerializeFMUState(Instance instance, void *kept, unsigned char *to, size_t size)
{
  (void)instance;
  return write_state(kept, to, size);
}

EXPORT Status fmi3DeserializeFMUState(Instance instance, const unsigned char *from, size_t size,
                                      void **to)
{
  (void)instance;
  return size == sizeof(State) ? copy_state(from, to) : ERROR;
}

#define PLAIN(name, status) EXPORT Status name(Instance instance) { (void)instance; return status; }
PLAIN(fmi3EnterEventMode, OK)
PLAIN(fmi3EnterContinuousTimeMode, OK)

EXPORT Status fmi3SetTime(Instance instance, double time) { STATE->time = time; return OK; }

EXPORT Status fmi3UpdateDiscreteStates(Instance instance, bool *needed, bool *terminate,
                                       bool *nominals_changed, bool *values_changed,
                                       bool *has_next_time, double *next_time)
{
  (void)instance;
  *needed = *terminate = *nominals_changed = *values_changed = *has_next_time = false;
  *next_time = 0.0;
  return OK;
}

EXPORT Status fmi3CompletedIntegratorStep(Instance instance, bool is_final, bool *enters_event,
                                          bool *terminates)
{
  (void)instance; (void)is_final;
  *enters_event = *terminates = false;
  return OK;
}

STATES(fmi3SetContinuousStates, const double *)
STATES(fmi3GetContinuousStateDerivatives, double *)
STATES(fmi3GetEventIndicators, double *)
STATES(fmi3GetContinuousStates, double *)
STATES(fmi3GetNominalsOfContinuousStates, double *)
#define NUMBER_OF(name) \
  EXPORT Status name(Instance instance, size_t *to) { (void)instance; *to = 0; return OK; }
NUMBER_OF(fmi3GetNumberOfEventIndicators)
NUMBER_OF(fmi3GetNumberOfContinuousStates)

/* Every number is a Float64 without events and derivatives; the functions must be there. */
#define NONE(name, type) \
  EXPORT Status fmi3Get##name(Instance instance, const unsigned *which, size_t count, type *to, \
                              size_t values) \
  { (void)instance; (void)which; (void)to; (void)values; return count == 0 ? OK : ERROR; } \
  EXPORT Status fmi3Set##name(Instance instance, const unsigned *which, size_t count, \
                              const type *from, size_t values) \
  { (void)instance; (void)which; (void)from; (void)values; return count == 0 ? OK : ERROR; }
NONE(Float32, float)
NONE(Int8, signed char)
NONE(UInt8, unsigned char)
NONE(Int16, short)
NONE(UInt16, unsigned short)
NONE(Int32, int)
NONE(UInt32, unsigned)
NONE(Int64, long long)
NONE(UInt64, unsigned long long)
NONE(Boolean, bool)
NONE(String, Text)

PLAIN(fmi3EnterConfigurationMode, ERROR)
PLAIN(fmi3ExitConfigurationMode, ERROR)
PLAIN(fmi3EvaluateDiscreteStates, ERROR)
PLAIN(fmi3EnterStepMode, ERROR)

#define WITH(name, arguments, unused) EXPORT Status name arguments { unused; return ERROR; }
WITH(fmi3GetBinary, (Instance i, const unsigned *w, size_t n, size_t *s, void **v, size_t m),
     (void)i; (void)w; (void)n; (void)s; (void)v; (void)m)
WITH(fmi3SetBinary, (Instance i, const unsigned *w, size_t n, const size_t *s, void *const *v,
                     size_t m), (void)i; (void)w; (void)n; (void)s; (void)v; (void)m)
WITH(fmi3GetClock, (Instance i, const unsigned *w, size_t n, bool *v),
     (void)i; (void)w; (void)n; (void)v)
WITH(fmi3SetClock, (Instance i, const unsigned *w, size_t n, const bool *v),
     (void)i; (void)w; (void)n; (void)v)
WITH(fmi3GetNumberOfVariableDependencies, (Instance i, unsigned w, size_t *n),
     (void)i; (void)w; (void)n)
WITH(fmi3GetVariableDependencies, (Instance i, unsigned w, size_t *a, unsigned *b, size_t *c,
                                   int *d, size_t n),
     (void)i; (void)w; (void)a; (void)b; (void)c; (void)d; (void)n)
WITH(fmi3GetAdjointDerivative, (Instance i, const unsigned *a, size_t b, const unsigned *c,
                                size_t d, const double *e, size_t f, double *g, size_t h),
     (void)i; (void)a; (void)b; (void)c; (void)d; (void)e; (void)f; (void)g; (void)h)
EXPORT Status fmi3GetDirectionalDerivative(Instance instance, const unsigned *of, size_t many,
                                           const unsigned *by, size_t count, const double *along,
                                           size_t directions, double *to, size_t length)
{
  if (directions != count || length != many) return ERROR;
  return derivatives(STATE, of, many, by, count, along, to);
}
WITH(fmi3GetOutputDerivatives, (Instance i, const unsigned *w, size_t n, const int *o, double *v,
                                size_t m),
     (void)i; (void)w; (void)n; (void)o; (void)v; (void)m)
WITH(fmi3GetIntervalDecimal, (Instance i, const unsigned *w, size_t n, double *a, int *b),
     (void)i; (void)w; (void)n; (void)a; (void)b)
WITH(fmi3SetIntervalDecimal, (Instance i, const unsigned *w, size_t n, const double *a),
     (void)i; (void)w; (void)n; (void)a)
WITH(fmi3GetShiftDecimal, (Instance i, const unsigned *w, size_t n, double *a),
     (void)i; (void)w; (void)n; (void)a)
WITH(fmi3SetShiftDecimal, (Instance i, const unsigned *w, size_t n, const double *a),
     (void)i; (void)w; (void)n; (void)a)
typedef unsigned long long Count;
WITH(fmi3GetIntervalFraction, (Instance i, const unsigned *w, size_t n, Count *a, Count *b,
                               int *c), (void)i; (void)w; (void)n; (void)a; (void)b; (void)c)
WITH(fmi3SetIntervalFraction, (Instance i, const unsigned *w, size_t n, const Count *a,
                               const Count *b), (void)i; (void)w; (void)n; (void)a; (void)b)
WITH(fmi3GetShiftFraction, (Instance i, const unsigned *w, size_t n, Count *a, Count *b),
     (void)i; (void)w; (void)n; (void)a; (void)b)
WITH(fmi3SetShiftFraction, (Instance i, const unsigned *w, size_t n, const Count *a,
                            const Count *b), (void)i; (void)w; (void)n; (void)a; (void)b)
WITH(fmi3ActivateModelPartition, (Instance i, unsigned w, double t), (void)i; (void)w; (void)t)
