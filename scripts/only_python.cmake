# For messages built beside the wheels, where only rclpy uses them: nothing for C++, which is a
# third of what there is to compile.
find_package(rosidl_default_generators REQUIRED)
list(FILTER AMENT_EXTENSIONS_rosidl_generate_idl_interfaces EXCLUDE REGEX "_cpp:")
