# Defines TBB::tbb. Debian 12's oneTBB brings CMake files; Ubuntu 20.04's TBB (2020.1) does not.
find_package(TBB QUIET CONFIG COMPONENTS tbb)
if(NOT TARGET TBB::tbb)
  find_path(TBB_INCLUDE_DIR tbb/tbb.h)
  find_library(TBB_LIBRARY tbb)
  if(NOT TBB_INCLUDE_DIR OR NOT TBB_LIBRARY)
    message(FATAL_ERROR "cloth_sim: TBB was not found (Debian: libtbb-dev)")
  endif()
  add_library(TBB::tbb UNKNOWN IMPORTED)
  set_target_properties(TBB::tbb PROPERTIES
    IMPORTED_LOCATION ${TBB_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${TBB_INCLUDE_DIR})
endif()
