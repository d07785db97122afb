# The tests. All are registered with catkin (catkin_make run_tests) and with ctest, and write JUnit
# files to build/test_results/cloth_sim. `make tests` builds them. scripts/lib/suites.txt lists the
# suites; scripts/test.sh fails if one of them was not built or not run.

if(NOT CATKIN_ENABLE_TESTING)
  return()
endif()
find_package(rostest QUIET)
find_package(rapidcheck QUIET)
if(NOT GMOCK_FOUND)
  cloth_sim_leave_out(gmock "GoogleMock was not found (Debian: libgmock-dev): the tests in C++ are "
    "not built")
endif()
if(NOT rapidcheck_FOUND)
  cloth_sim_leave_out(rapidcheck "RapidCheck was not found (Debian: librapidcheck-dev): the property "
    "tests are not built")
endif()
if(NOT rostest_FOUND)
  cloth_sim_leave_out(rostest "rostest was not found (Debian: librostest-dev): the tests with a ROS "
    "master are not built")
endif()

# Programs of bench/: with sanitizers, no test would run them.
if(NOT CLOTH_SIM_SANITIZE)
  foreach(program cloth_bench peer_bullet peer_layers node_clients)
    if(TARGET ${program})
      add_dependencies(tests ${program})
    endif()
  endforeach()
endif()

# cloth_sim_test_options(<target>): what all test programs have in common. Headers of the tests are
# found in test/, the shipped scenes in CLOTH_SIM_SOURCE_DIR. Undefined behaviour is looked for in the
# libraries and programs, not in the tests' own code, for which the compiler would need five times as
# long.
function(cloth_sim_test_options target)
  cloth_sim_compile_options(${target})
  if(CLOTH_SIM_SANITIZE MATCHES undefined)
    target_compile_options(${target} PRIVATE -fno-sanitize=undefined)
  endif()
  target_include_directories(${target} PRIVATE test)
  target_compile_definitions(${target} PRIVATE CLOTH_SIM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
endfunction()

# ---- tests in C++ that need no master ------------------------------------------------------------

# test/<folder>/*.cpp: one program for each folder. A file whose name begins with `property` uses
# RapidCheck. Tests without a main() get GoogleMock's.
function(cloth_sim_unit_tests folder library)
  file(GLOB sources CONFIGURE_DEPENDS test/${folder}/*.cpp)
  set(property_sources ${sources})
  list(FILTER property_sources INCLUDE REGEX "/property[^/]*$")
  if(NOT rapidcheck_FOUND)
    list(FILTER sources EXCLUDE REGEX "/property[^/]*$")
    set(property_sources)
  endif()
  string(REPLACE "/" "_" target cloth_sim_${folder}_test)
  catkin_add_gmock(${target} ${sources})
  cloth_sim_test_options(${target})
  cloth_sim_arithmetic(${target})
  target_link_libraries(${target} ${library} ${GMOCK_MAIN_LIBRARIES})
  if(property_sources)
    target_link_libraries(${target} rapidcheck)
  endif()
endfunction()

if(GMOCK_FOUND)
  foreach(folder unit verify surgery determinism allocation fuzz)
    cloth_sim_unit_tests(${folder} cloth_core)
  endforeach()
  # GCC 12 takes the empty std::optional<Seam> of the tearing settings for uninitialised memory where
  # it inlines the destructor (GCC bug 105562 and others).
  target_compile_options(cloth_sim_surgery_test PRIVATE
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  cloth_sim_unit_tests(study cloth_exact)
  cloth_sim_unit_tests(ros/unit cloth_ros)
endif()

# ---- tests of the command-line programs ----------------------------------------------------------

# test/tools/*_test.py: without a master. Each ends in
# rosunit.unitrun('cloth_sim', '<name>', TheTestCase).
file(GLOB tool_tests CONFIGURE_DEPENDS test/tools/*_test.py)
if(TARGET cloth_run)
  foreach(file ${tool_tests})
    get_filename_component(name ${file} NAME_WE)
    set(xml tool-${name}.xml)
    set(xml_path ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/${xml})
    catkin_run_tests_target(tool ${name} ${xml}
      COMMAND "${PYTHON_EXECUTABLE} ${file} --gtest_output=xml:${xml_path}"
      DEPENDENCIES cloth_run cloth_study cloth_node)
  endforeach()
endif()

# ---- tests with a master -------------------------------------------------------------------------

if(NOT rostest_FOUND)
  return()
endif()

# test/ros/flooder.cpp: a client that is faster than Python.
add_executable(flooder EXCLUDE_FROM_ALL test/ros/flooder.cpp)
cloth_sim_compile_options(flooder)
cloth_sim_use_ros(flooder)
add_dependencies(tests flooder)

# test/ros/<name>.test: each starts a node and the script <name>_test.py beside it.
file(GLOB rostest_files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} test/ros/*.test)
foreach(file ${rostest_files})
  add_rostest(${file} DEPENDENCIES cloth_node tear_client fold_client flooder)
endforeach()

# test/rviz: the plugin, in rviz and by itself.
if(TARGET cloth_rviz)
  add_rostest(test/rviz/rviz.test DEPENDENCIES cloth_node cloth_rviz)
  if(GMOCK_FOUND)
    add_rostest_gmock(cloth_sim_panel_test test/rviz/panel.test test/rviz/panel_test.cpp)
    set_target_properties(cloth_sim_panel_test PROPERTIES OUTPUT_NAME panel_test)
    cloth_sim_test_options(cloth_sim_panel_test)
    target_include_directories(cloth_sim_panel_test SYSTEM PRIVATE ${rviz_INCLUDE_DIRS})
    target_compile_definitions(cloth_sim_panel_test PRIVATE QT_NO_KEYWORDS)
    target_link_libraries(cloth_sim_panel_test cloth_rviz ${rviz_LIBRARIES} Qt5::Widgets)
    add_dependencies(cloth_sim_panel_test cloth_node)
  endif()
endif()
