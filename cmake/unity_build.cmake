# cloth_sim_unity_build(<target>): compiles the files of a folder in groups of eight, so that headers
# are read and templates instantiated once for each group. This saves two fifths of the time of a
# build from nothing. Names without linkage must therefore differ between the files of a folder.
# With a compiler launcher (ccache), files are compiled one by one, because the cache then keeps
# more of them after an edit.
option(CLOTH_SIM_UNITY_BUILD "Compile the files of a folder in groups" ON)
function(cloth_sim_unity_build target)
  if(NOT CLOTH_SIM_UNITY_BUILD OR CMAKE_CXX_COMPILER_LAUNCHER OR CMAKE_VERSION VERSION_LESS 3.18)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  set(files_in_a_group 8)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(folder ${folder} NAME)
    math(EXPR group "0${count_${folder}} / ${files_in_a_group}")
    math(EXPR count_${folder} "0${count_${folder}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
  endforeach()
endfunction()
