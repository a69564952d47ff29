
/// Its motion by torque, in steps of the node. No call allocates, locks or throws.
class Drive
{
public:
  explicit Drive(FIRST) {NAME_start(&state_ PASSED);}
  NAME_drive_status advance(double step ARGUMENT) {return NAME_advance(&state_, step PASSED);}
  const NAME_drive & state() const {return state_;}

private:
  NAME_drive state_;
};
