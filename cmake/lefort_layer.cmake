# One static library per line of src/lefort/LAYERS, linked to exactly the layers that line names.

# Sets LEFORT_LAYERS (in order) and LEFORT_LAYER_<name> (what <name> may include).
function(lefort_read_layers file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(STRINGS ${file} lines)
  foreach(line IN LISTS lines)
    if(NOT line MATCHES "^([a-z]+) *:(.*)$")
      continue()
    endif()
    set(name ${CMAKE_MATCH_1})
    separate_arguments(dependencies UNIX_COMMAND "${CMAKE_MATCH_2}")
    foreach(dependency IN LISTS dependencies)
      if(NOT dependency IN_LIST names)
        message(FATAL_ERROR "LAYERS: ${name} names ${dependency}, which is not declared above it")
      endif()
    endforeach()
    list(APPEND names ${name})
    set(LEFORT_LAYER_${name} "${dependencies}" PARENT_SCOPE)
  endforeach()
  set(LEFORT_LAYERS "${names}" PARENT_SCOPE)
endfunction()

# Unity builds (LEFORT_UNITY): sources that share their headers are compiled together, which divides the
# time of a first build by three or more. Sources with many instances of Eigen's templates are compiled
# apart: g++ searches the aliases of `double` one by one, so that its time grows with the square of their
# number in a unit. Names in anonymous namespaces must therefore differ within a
# layer. -Wsubobject-linkage takes every included source for a header; it stays on without unity builds.
#
# CMake's own unity sources name ours by absolute paths; these by paths below the root, so that ccache finds the
# objects of another clone.
function(lefort_unity target batch)
  if(LEFORT_UNITY)
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
    # At the end of the folder, when all properties of its sources are set.
    cmake_language(EVAL CODE "cmake_language(DEFER CALL lefort_write_units ${target} ${batch})")
  endif()
endfunction()

# lefort_write_units(target batch): compiles the sources of a target in units of `batch`, apart by UNITY_GROUP. Sources
# with SKIP_UNITY_BUILD_INCLUSION or with options of their own are compiled alone.
function(lefort_write_units target batch)
  get_target_property(sources ${target} SOURCES)
  set(groups "")
  foreach(source IN LISTS sources)
    get_source_file_property(skip ${source} SKIP_UNITY_BUILD_INCLUSION)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    get_source_file_property(group ${source} UNITY_GROUP)
    if(skip OR options OR NOT source MATCHES "\\.cpp$")
      continue()
    endif()
    if(NOT group)
      set(group sources)
    endif()
    list(APPEND groups ${group})
    list(APPEND sources_of_${group} ${source})
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group IN LISTS groups)
    set(rest ${sources_of_${group}})
    set(number 0)
    while(rest)
      list(SUBLIST rest 0 ${batch} unit)
      list(REMOVE_ITEM rest ${unit})
      lefort_write_unit(${target} ${CMAKE_CURRENT_BINARY_DIR}/units/${target}_${group}_${number}.cpp ${unit})
      math(EXPR number "${number} + 1")
    endwhile()
  endforeach()
endfunction()

function(lefort_write_unit target file)
  set(content "")
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE path)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    string(APPEND content "#include \"${path}\"\n")
    set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
  endforeach()
  file(CONFIGURE OUTPUT ${file} CONTENT "${content}" @ONLY)
  target_sources(${target} PRIVATE ${file})
endfunction()

# Commands, HTTP, files and what prepares a solve: -O2 and -O3 cost a quarter more to compile and gain nothing.
set(LEFORT_O1_LAYERS plan compare solve io verify pipeline server app)
# Mostly templates of CGAL, or work that libraries do: -O3 costs a twelfth more and gains nothing.
set(LEFORT_O2_LAYERS mesh predict report bench)

# lefort_layer(name files...): lefort_<name>, alias lefort::<name>. A layer of headers alone is an
# INTERFACE library.
function(lefort_layer name)
  if(ARGN)
    add_library(lefort_${name} STATIC ${ARGN})
    set(scope PUBLIC)
    target_link_libraries(lefort_${name} PUBLIC lefort_options)
    lefort_unity(lefort_${name} 64)
    if(CMAKE_BUILD_TYPE STREQUAL Release)
      foreach(level IN ITEMS 1 2)
        if(name IN_LIST LEFORT_O${level}_LAYERS)
          target_compile_options(lefort_${name} PRIVATE -O${level})
        endif()
      endforeach()
    endif()
  else()
    add_library(lefort_${name} INTERFACE)
    set(scope INTERFACE)
    target_link_libraries(lefort_${name} INTERFACE lefort_options)
  endif()
  add_library(lefort::${name} ALIAS lefort_${name})
  foreach(dependency IN LISTS LEFORT_LAYER_${name})
    target_link_libraries(lefort_${name} ${scope} lefort::${dependency})
  endforeach()
endfunction()

# lefort_test(layer [SLOW] files...): the test program test_<layer>; ctest runs it in one go, so that
# start-up (ITK registers its readers) is paid once. SLOW goes into its own program, label `slow`.
function(lefort_test layer)
  cmake_parse_arguments(TEST "SLOW" "NAME" "LINK" ${ARGN})
  set(name test_${layer})
  set(label fast)
  if(TEST_SLOW)
    set(name test_${layer}_slow)
    set(label slow)
  endif()
  if(TEST_NAME)
    set(name ${TEST_NAME})
  endif()
  add_executable(${name} ${TEST_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE lefort::${layer} ${TEST_LINK} GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  lefort_unity(${name} 8)
  if(CMAKE_BUILD_TYPE STREQUAL Release)
    target_compile_options(${name} PRIVATE -O1)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT 900)
  if(LEFORT_SANITIZE)
    # Suppressions name libraries alone; programs that a test starts get them, too. ITK's threads
    # would be suppressed anyway, report by report, which takes hours.
    set(supp ${PROJECT_SOURCE_DIR}/tests)
    set_tests_properties(${name} PROPERTIES TIMEOUT 5400 ENVIRONMENT
      "LSAN_OPTIONS=suppressions=${supp}/lsan.supp:print_suppressions=0;TSAN_OPTIONS=suppressions=${supp}/tsan.supp;ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS=1")
  endif()
endfunction()
