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
