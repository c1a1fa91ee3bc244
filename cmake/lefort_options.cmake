# What every target of ours is compiled with.
add_library(lefort_options INTERFACE)
target_compile_features(lefort_options INTERFACE cxx_std_20)
target_compile_options(lefort_options INTERFACE
  $<BUILD_INTERFACE:-Wall$<SEMICOLON>-Wextra$<SEMICOLON>-Wpedantic$<SEMICOLON>-Wconversion$<SEMICOLON>-Wshadow>
  $<BUILD_INTERFACE:$<$<BOOL:${LEFORT_WARNINGS_AS_ERRORS}>:-Werror>>
  # No garbage collection below 1 GB (kB): 8 to 17 % of the compile time of a unit (docs/studies/build-time.md).
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>>
  # Position-independent code calls its own functions directly, as in a program.
  $<BUILD_INTERFACE:-fno-semantic-interposition>
  # Same bits on every machine: no fused multiply-add behind our back.
  -ffp-contract=off)
target_include_directories(lefort_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
  $<INSTALL_INTERFACE:include>)
if(LEFORT_SANITIZE)
  target_compile_options(lefort_options INTERFACE
    -fsanitize=${LEFORT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -Wno-maybe-uninitialized)  # False alarms in CGAL's headers, from the checks themselves.
  target_link_options(lefort_options INTERFACE -fsanitize=${LEFORT_SANITIZE})
endif()
