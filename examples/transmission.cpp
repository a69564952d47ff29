// Copyright 2026 fourbar_ros developers
// SPDX-License-Identifier: Apache-2.0
//
// A linkage between a motor and a joint, for read() and write() of a ros2_control hardware
// interface or a plugin of Gazebo. First:  fourbar generate paper -o .  Then:
//   cc -std=c99 -O2 -c paper.c && c++ -std=c++17 transmission.cpp paper.o -o transmission
#include <cmath>
#include <cstdio>
#include "paper.h"

struct Joint {double position, velocity, effort;};

// read(): motor to joint. Without masses power is kept; the loads have the masses.
bool to_joint(const paper_constants & by, const Joint & motor, Joint & joint)
{
  paper_motion at;
  const paper_input input{motor.position, motor.velocity, 0.0};
  if (paper_motion_at(&by, &input, &at) != paper_ok) {return false;}         // out of range, toggle
  joint = {at.theta4, at.omega4, motor.effort / at.velocity_ratio};
  return std::fabs(at.velocity_ratio) > 1e-6;                   // a dead point has no effort
}

// write(): joint to motor, by at most eight steps of Newton from where the motor is.
bool to_motor(const paper_constants & by, const Joint & joint, Joint & motor)
{
  paper_motion at;
  for (int i = 0; i < 8; ++i) {
    const paper_input input{motor.position, 0.0, 0.0};
    if (paper_motion_at(&by, &input, &at) != paper_ok) {return false;}
    const double ratio = at.velocity_ratio, error = std::remainder(joint.position - at.theta4, 2 * M_PI);
    motor = {motor.position, joint.velocity / ratio, joint.effort * ratio};
    if (std::fabs(error) < 1e-12) {return true;}
    motor.position += error / ratio;
  }
  return false;
}

int main()
{
  paper_parameters lengths_and_masses;
  paper_constants by;                           // what follows from them once and for all
  paper_defaults(&lengths_and_masses);
  paper_prepare(&lengths_and_masses, &by);
  Joint motor{1.0, 25.0, 3.0}, joint, back{0.9, 0.0, 0.0};
  const bool good = to_joint(by, motor, joint) && to_motor(by, joint, back);
  std::printf("%.12f %.12f %.12f\n", back.position, back.velocity, back.effort);
  return good ? 0 : 1;
}
