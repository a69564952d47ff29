// --- function
static int WHICH_of(const double *k, double x0, double x1, double x2, double *values,
    double *closes)
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
  double closes = NAN;
  int status = first_look(x0, x1, x2);
  if (status != INVALID_INPUT) {
    int refused = WHICH_of(with->k, x0, x1, x2, values, &closes);
AT_ZERO    status = judged(status, refused, closes, x0, values, LOADS);
  }
  if (status != 0) without_answer(status, x1, x2, values, LOADS);
  if (status == 1 || status == 2) {
INPUTS  }
  memcpy(motion, values, sizeof *motion);
COPY  return (NAME_status)status;
}
// --- loads
SIGNATURE
{
  NAME_motion motion;
  return NAME_step(with, input, &motion, loads);
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
