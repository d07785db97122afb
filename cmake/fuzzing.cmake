# fuzz_<target>: the programs of libFuzzer, over the functions in test/fuzz/fuzz_targets.h.
if(NOT CLOTH_SIM_FUZZ)
  return()
endif()
if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  message(FATAL_ERROR "cloth_sim: CLOTH_SIM_FUZZ needs clang, which brings libFuzzer")
endif()

add_custom_target(fuzzers)
foreach(name state scene obj surface stroke command)
  add_executable(fuzz_${name} EXCLUDE_FROM_ALL
    test/fuzz/libfuzzer/libfuzzer_main.cpp test/fuzz/fuzz_targets.cpp)
  cloth_sim_compile_options(fuzz_${name})
  cloth_sim_arithmetic(fuzz_${name})
  target_include_directories(fuzz_${name} PRIVATE test)
  target_compile_definitions(fuzz_${name} PRIVATE
    CLOTH_SIM_SOURCE_DIR="${PROJECT_SOURCE_DIR}" CLOTH_SIM_FUZZ_TARGET="${name}")
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  target_link_libraries(fuzz_${name} cloth_core)
  add_dependencies(fuzzers fuzz_${name})
endforeach()
