# Finds SUNDIALS CVODE 6 or later (the first version whose functions take a context). SUNDIALS's own
# CMake files also ask for every library that it was built with, which the study does not need.
#
# Sets CVODE_FOUND, CVODE_LIBRARIES and CVODE_INCLUDE_DIR.
find_path(CVODE_INCLUDE_DIR cvode/cvode.h DOC "The folder above cvode/cvode.h")
find_library(CVODE_LIBRARY sundials_cvode)
find_library(CVODE_NVECTOR_LIBRARY sundials_nvecserial)
if(CVODE_INCLUDE_DIR AND EXISTS ${CVODE_INCLUDE_DIR}/sundials/sundials_context.h)
  set(CVODE_HAS_CONTEXTS TRUE)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CVODE
  REQUIRED_VARS CVODE_LIBRARY CVODE_NVECTOR_LIBRARY CVODE_INCLUDE_DIR CVODE_HAS_CONTEXTS)
set(CVODE_LIBRARIES ${CVODE_LIBRARY} ${CVODE_NVECTOR_LIBRARY})
