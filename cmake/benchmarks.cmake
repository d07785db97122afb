# The programs of bench/. None is built by default; `make tests` builds them all, so that they keep
# compiling, but does not run them.

# bench/kernels: one program with Google Benchmark, which needs no ROS master; `make cloth_bench`.
find_package(benchmark QUIET)
file(GLOB bench_sources CONFIGURE_DEPENDS bench/kernels/*.cpp)
if(benchmark_FOUND)
  add_executable(cloth_bench EXCLUDE_FROM_ALL ${bench_sources})
  cloth_sim_compile_options(cloth_bench)
  cloth_sim_arithmetic(cloth_bench)
  target_link_libraries(cloth_bench cloth_ros benchmark::benchmark_main)
else()
  cloth_sim_leave_out(benchmark "Google Benchmark was not found (Debian: libbenchmark-dev): "
    "cloth_bench is not built")
endif()

# bench/node/<name>.cpp: clients of bench/node_overhead; `make node_clients`.
file(GLOB client_sources CONFIGURE_DEPENDS bench/node/*.cpp)
add_custom_target(node_clients DEPENDS cloth_node)
foreach(source ${client_sources})
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  cloth_sim_compile_options(${name})
  cloth_sim_use_ros(${name})
  add_dependencies(node_clients ${name})
endforeach()

# bench/peer: the same scenes in this package and in Bullet; `make peer_bullet`. bench/layers: contact
# between layers in both; `make peer_layers`.
find_package(Bullet CONFIG QUIET)
if(BULLET_FOUND)
  foreach(pair "peer_bullet peer" "peer_layers layers")
    separate_arguments(pair)
    list(GET pair 0 name)
    list(GET pair 1 folder)
    file(GLOB peer_sources CONFIGURE_DEPENDS bench/${folder}/*.cpp)
    add_executable(${name} EXCLUDE_FROM_ALL ${peer_sources})
    cloth_sim_compile_options(${name})
    target_include_directories(${name} SYSTEM PRIVATE ${BULLET_ROOT_DIR}/${BULLET_INCLUDE_DIR})
    target_link_libraries(${name} cloth_study_core BulletSoftBody BulletDynamics BulletCollision
      LinearMath)
  endforeach()
else()
  cloth_sim_leave_out(bullet
    "Bullet was not found (Debian: libbullet-dev): peer_bullet and peer_layers are not built")
endif()
