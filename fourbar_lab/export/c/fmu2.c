typedef void *Component;
typedef const char *Text;
typedef int Status;
typedef void (*Log)(void *, Text, Status, Text, Text, ...);
typedef struct {
  Log logger;
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void *, Status);
  void *environment;
} Callbacks;
enum { OK = 0, ERROR = 3 };
#define STATE ((State *)component)

EXPORT Text fmi2GetTypesPlatform(void);
EXPORT Text fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Text fmi2GetVersion(void);
EXPORT Text fmi2GetVersion(void) { return "2.0"; }

EXPORT Component fmi2Instantiate(Text name, int type, Text guid, Text resources,
                                 const Callbacks *callbacks, int visible, int logs)
{
  State *state;
  (void)resources; (void)visible; (void)logs;
  if ((type != 1 && !EXCHANGES) || guid == NULL || strcmp(guid, "GUID") != 0) {
    if (callbacks && callbacks->logger)
      callbacks->logger(callbacks->environment, name, ERROR, "logStatusError",
                        EXCHANGES ? "NAME: another guid"
                                  : "NAME: co-simulation only, or another guid");
    return NULL;
  }
  state = (State *)calloc(1, sizeof *state);
  if (state) reset(state);
  return state;
}

EXPORT void fmi2FreeInstance(Component component) { free(component); }

EXPORT Status fmi2SetDebugLogging(Component component, int on, size_t count, const Text *which)
{
  (void)component; (void)on; (void)count; (void)which;
  return OK;
}

EXPORT Status fmi2SetupExperiment(Component component, int with_tolerance, double tolerance,
                                  double start, int with_end, double end)
{
  (void)with_tolerance; (void)tolerance; (void)with_end; (void)end;
  STATE->time = start;
  return OK;
}

EXPORT Status fmi2EnterInitializationMode(Component component) { (void)component; return OK; }
EXPORT Status fmi2ExitInitializationMode(Component component) { (void)component; return OK; }
EXPORT Status fmi2Terminate(Component component) { (void)component; return OK; }
EXPORT Status fmi2Reset(Component component) { reset(STATE); return OK; }

EXPORT Status fmi2GetReal(Component component, const unsigned *which, size_t count, double *to)
{
  return get_numbers(STATE, which, count, to);
}

EXPORT Status fmi2SetReal(Component component, const unsigned *which, size_t count,
                          const double *from)
{
  return set_numbers(STATE, which, count, from);
}

EXPORT Status fmi2DoStep(Component component, double time, double step, int is_final)
{
  (void)is_final;
  if (!(step >= 0.0 && step < HUGE_VAL)) return ERROR;
  ADVANCE
  STATE->time = time + step;
  return OK;
}

EXPORT Status fmi2GetFMUstate(Component component, void **to)
{
  return copy_state(component, to);
}

EXPORT Status fmi2SetFMUstate(Component component, void *from)
{
  memcpy(component, from, sizeof(State));
  return OK;
}

EXPORT Status fmi2FreeFMUstate(Component component, void **kept)
{
  (void)component;
  return free_state(kept);
}

EXPORT Status fmi2SerializedFMUstateSize(Component component, void *kept, size_t *size)
{
  (void)component; (void)kept;
  *size = sizeof(State);
  return OK;
}

EXPORT Status fmi2SerializeFMUstate(Component component, void *kept, char *to, size_t size)
{
  (void)component;
  return write_state(kept, to, size);
}

EXPORT Status fmi2DeSerializeFMUstate(Component component, const char *from, size_t size,
                                      void **to)
{
  (void)component;
  return size == sizeof(State) ? copy_state(from, to) : ERROR;
}

typedef struct {
  int new_states_needed, terminate, nominals_changed, values_changed, has_next_time;
  double next_time;
} EventInfo;

EXPORT Status fmi2EnterEventMode(Component component) { (void)component; return OK; }
EXPORT Status fmi2EnterContinuousTimeMode(Component component) { (void)component; return OK; }
EXPORT Status fmi2SetTime(Component component, double time) { STATE->time = time; return OK; }

EXPORT Status fmi2NewDiscreteStates(Component component, EventInfo *to)
{
  (void)component;
  memset(to, 0, sizeof *to);
  return OK;
}

EXPORT Status fmi2CompletedIntegratorStep(Component component, int is_final, int *enters_event,
                                          int *terminates)
{
  (void)component; (void)is_final;
  *enters_event = *terminates = 0;
  return OK;
}

STATES(fmi2SetContinuousStates, const double *)
STATES(fmi2GetDerivatives, double *)
STATES(fmi2GetEventIndicators, double *)
STATES(fmi2GetContinuousStates, double *)
STATES(fmi2GetNominalsOfContinuousStates, double *)

/* Every number is real and no step is pending; the functions must be there all the same. */
#define NONE(name, type) \
  EXPORT Status name(Component component, const unsigned *which, size_t count, type values) \
  { (void)component; (void)which; (void)values; return count == 0 ? OK : ERROR; }
NONE(fmi2GetInteger, int *)
NONE(fmi2GetBoolean, int *)
NONE(fmi2GetString, Text *)
NONE(fmi2SetInteger, const int *)
NONE(fmi2SetBoolean, const int *)
NONE(fmi2SetString, const Text *)
#define UNKNOWN(name, type) \
  EXPORT Status name(Component component, int kind, type value) \
  { (void)component; (void)kind; (void)value; return ERROR; }
UNKNOWN(fmi2GetStatus, Status *)
UNKNOWN(fmi2GetRealStatus, double *)
UNKNOWN(fmi2GetIntegerStatus, int *)
UNKNOWN(fmi2GetBooleanStatus, int *)
UNKNOWN(fmi2GetStringStatus, Text *)
EXPORT Status fmi2CancelStep(Component component) { (void)component; return ERROR; }

EXPORT Status fmi2GetDirectionalDerivative(Component component, const unsigned *of, size_t many,
                                           const unsigned *by, size_t count,
                                           const double *along, double *to)
{
  return derivatives(STATE, of, many, by, count, along, to);
}

EXPORT Status fmi2SetRealInputDerivatives(Component component, const unsigned *which,
                                          size_t count, const int *order, const double *values)
{
  (void)component; (void)which; (void)count; (void)order; (void)values;
  return ERROR;
}

EXPORT Status fmi2GetRealOutputDerivatives(Component component, const unsigned *which,
                                           size_t count, const int *order, double *values)
{
  (void)component; (void)which; (void)count; (void)order; (void)values;
  return ERROR;
}
