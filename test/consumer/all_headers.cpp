#include "all_headers.h"  // made by CMakeLists.txt

static_assert(sizeof(cloth_sim::Simulation) > 0, "the headers of cloth_sim are complete");
