// Wrapper of NAME.h in a namespace. Not to be edited.
#ifndef GUARD
#define GUARD
#include "NAME.h"

namespace fourbar
{
namespace NAME
{
using Input = NAME_input;
using Parameters = NAME_parameters;
using Motion = NAME_motion;
USING_LOADSusing Status = NAME_status;

inline Parameters defaults()
{
  Parameters found;
  NAME_defaults(&found);
  return found;
}

/// One linkage; it keeps what follows from its parameters. No call allocates, locks or throws.
class Linkage
{
public:
  explicit Linkage(const Parameters & given = defaults()) {set(given);}
  void set(const Parameters & given) {NAME_prepare(&given, &constants_);}
  Status motion(const Input & at, Motion & to) const {return NAME_motion_at(&constants_, &at, &to);}
OF_BOTH

private:
  NAME_constants constants_;
};
DRIVE
}  // namespace NAME
}  // namespace fourbar
#endif
// --- loads
  Status step(const Input & at, Motion & to, Loads & loads) const
  {
    return NAME_step(&constants_, &at, &to, &loads);
  }
// --- drive

/// Its motion by torque, in steps of the node. No call allocates, locks or throws.
class Drive
{
public:
  explicit Drive(FIRST) {NAME_start(&state_ PASSED);}
  NAME_drive_status advance(double step ARGUMENT) {return NAME_advance(&state_, step PASSED);}
  const NAME_drive & state() const {return state_;}
  NAME_drive & state() {return state_;}

private:
  NAME_drive state_;
};
