#include "../ros_doubles.hpp"
