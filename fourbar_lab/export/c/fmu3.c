EXPORT Text fmi3GetVersion(void) { return "3.0"; }

EXPORT Instance fmi3InstantiateCoSimulation(
  Text name, Text token, Text resources, bool visible, bool logs, bool events, bool early,
  const unsigned *variables, size_t count, void *environment, void *logger, void *update)
{
  (void)name; (void)resources; (void)visible; (void)logs; (void)events; (void)early;
  (void)variables; (void)count; (void)environment; (void)logger; (void)update;
  return new_instance(token);
}

/* Motion by torque is for co-simulation only. */
EXPORT Instance fmi3InstantiateModelExchange(Text name, Text token, Text resources, bool visible,
                                             bool logs, void *environment, void *logger)
{
  (void)name; (void)resources; (void)visible; (void)logs; (void)environment; (void)logger;
  return EXCHANGES ? new_instance(token) : NULL;
}

EXPORT Instance fmi3InstantiateScheduledExecution(void) { return NULL; }

EXPORT Status fmi3EnterInitializationMode(Instance instance, bool with_tolerance,
                                          double tolerance, double start, bool with_end,
                                          double end)
{
  (void)with_tolerance; (void)tolerance; (void)with_end; (void)end;
  STATE->time = start;
  return OK;
}

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
  *event = *terminate = *early = false;
  *last = time + step;
  return do_step(STATE, time, step);
}

EXPORT Status fmi3UpdateDiscreteStates(Instance instance, bool *needed, bool *terminate,
                                       bool *nominals_changed, bool *values_changed,
                                       bool *has_next_time, double *next_time)
{
  (void)instance;
  *needed = *terminate = *nominals_changed = *values_changed = *has_next_time = false;
  *next_time = 0.0;
  return OK;
}

STATES(fmi3GetContinuousStateDerivatives, double *)
#define NUMBER_OF(name) \
  EXPORT Status name(Instance instance, size_t *to) { (void)instance; *to = 0; return OK; }
NUMBER_OF(fmi3GetNumberOfEventIndicators)
NUMBER_OF(fmi3GetNumberOfContinuousStates)

/* Every number is a Float64 without events and derivatives; the functions must be there. */
#define NONE(name) \
  EXPORT Status name(Instance instance, const unsigned *which, size_t count, const void *to, \
                     size_t values) \
  { (void)instance; (void)which; (void)to; (void)values; return count == 0 ? OK : ERROR; }
