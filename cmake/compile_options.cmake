# The compiler's options of every target. Include paths are given to each target too, never with
# include_directories(): cloth_core must not see ROS.
function(cloth_sim_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  # The standard is also set as a property, so that clang-tidy sees it: GCC's default is newer than
  # clang's.
  set_target_properties(${target} PROPERTIES CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON
                        CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow)
  # Private headers live in src/ and are included as "folder/name.h". The option is -iquote, not -I,
  # because <ros/x.h> and <rviz/x.h> must not be looked for in src/ros and src/rviz.
  target_compile_options(${target} PRIVATE "SHELL:-iquote ${PROJECT_SOURCE_DIR}/src")
  # A register of SIMD may begin at any number (support/simd.h). Clang forgets that behind a reference,
  # and takes moves that fault. With less than 8, it would call libatomic for atomic words.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:Clang>:-fmax-type-align=8>)
  # Older compilers, such as GCC 9 of Ubuntu 20.04, warn of faults that are none.
  if(CLOTH_SIM_WERROR AND NOT CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(CLOTH_SIM_FUZZ)  # counts branches; only the programs of libFuzzer get its main()
    # Loops that count their branches are not vectorised.
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link -Wno-pass-failed)
    target_link_options(${target} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
  if(CLOTH_SIM_SANITIZE)
    # GCC reports uninitialised values in the code that sanitizers add (GCC bug 105562 and others);
    # clang does not know the option.
    target_compile_options(${target} PRIVATE -fsanitize=${CLOTH_SIM_SANITIZE}
                           -fno-omit-frame-pointer -g1
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(${target} PUBLIC -fsanitize=${CLOTH_SIM_SANITIZE})
  endif()
  if(CLOTH_SIM_SANITIZE MATCHES address)
    # Eigen takes memory of malloc as it is, as in the libraries of Debian: those allocate what we
    # free and the other way round. With this sanitizer its headers would add a pointer of their own.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
  if(CLOTH_SIM_SANITIZE MATCHES address.*undefined)
    # Checks of pointers before they are followed: the sanitizer for addresses sees what comes of a bad
    # one. Without them Eigen's functions are inlined; the compiler and the tests need a third of the
    # time. scripts/fuzz.sh builds with clang, which keeps them.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-fno-sanitize=null,alignment,pointer-overflow,object-size>)
  endif()
endfunction()

# Links a shared library only if it lists all libraries that it uses. Not for clang's sanitizers and
# libFuzzer: their runtime is in the program, and libraries find it there.
function(cloth_sim_complete target)
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang AND (CLOTH_SIM_SANITIZE OR CLOTH_SIM_FUZZ))
    return()
  endif()
  target_link_options(${target} PRIVATE -Wl,--no-undefined)
endfunction()

# Options for arithmetic that gives the same bits on every machine and at every number of threads:
# no -ffast-math, no -march=native (hot kernels use target_clones instead), and no contraction into
# fused multiply-adds, in which those clones would differ. The two options that relax something
# change no result: nobody reads errno or floating-point traps here.
function(cloth_sim_arithmetic target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math)
endfunction()
