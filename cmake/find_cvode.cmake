# Finds SUNDIALS CVODE (6 or later: its functions take a context). Its own CMake files would also
# ask for every library that it was built with.
find_path(CVODE_INCLUDE_DIR cvode/cvode.h DOC "The folder above cvode/cvode.h")
find_library(CVODE_LIBRARY sundials_cvode)
find_library(CVODE_NVECTOR_LIBRARY sundials_nvecserial)
set(CVODE_LIBRARIES)
if(CVODE_INCLUDE_DIR AND CVODE_LIBRARY AND CVODE_NVECTOR_LIBRARY
   AND EXISTS ${CVODE_INCLUDE_DIR}/sundials/sundials_context.h)
  set(CVODE_LIBRARIES ${CVODE_LIBRARY} ${CVODE_NVECTOR_LIBRARY})
endif()
