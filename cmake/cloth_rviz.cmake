# libcloth_rviz: the display, tools and panel for rviz (plugin_description.xml), built where rviz's
# headers and Qt 5 are found. Without it, launch files show markers.

if(CLOTH_SIM_SANITIZE)
  cloth_sim_leave_out(rviz "a build with sanitizers has no rviz plugin, because rviz itself does not "
    "load the sanitizer's runtime")
  return()
endif()
find_package(rviz QUIET)
find_package(Qt5 QUIET COMPONENTS Widgets)
if(NOT rviz_FOUND OR NOT Qt5_FOUND)
  cloth_sim_leave_out(rviz "rviz's headers or Qt 5 were not found (Debian: librviz-dev qtbase5-dev): "
    "the rviz plugin and its tests are not built")
  return()
endif()

file(GLOB rviz_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/rviz/*.cpp)
add_library(cloth_rviz ${rviz_sources})
cloth_sim_compile_options(cloth_rviz)
cloth_sim_unity_build(cloth_rviz)
# Qt's keywords (signals, slots, emit) are ordinary names in other libraries' headers.
target_compile_definitions(cloth_rviz PRIVATE QT_NO_KEYWORDS)
target_link_libraries(cloth_rviz PUBLIC cloth_ros PRIVATE Qt5::Widgets)
target_include_directories(cloth_rviz SYSTEM PRIVATE ${rviz_INCLUDE_DIRS})
target_link_libraries(cloth_rviz PRIVATE ${rviz_LIBRARIES})
list(APPEND installed_targets cloth_rviz)
