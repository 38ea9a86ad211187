# Compile settings that every target of planish shares, third-party ones not.
add_library(planish_settings INTERFACE)
target_compile_options(planish_settings INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Werror
                                                  -ffp-contract=off -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # False alarms of g++ 12 inside std::string and tl::expected (its bugs 105329 and 105562).
  target_compile_options(planish_settings INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
endif()
target_include_directories(planish_settings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(planish_settings INTERFACE $<$<CONFIG:Debug>:PLANISH_ASSERTS>)

if(PLANISH_SANITIZE)
  add_compile_options(-fsanitize=${PLANISH_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${PLANISH_SANITIZE})
  add_compile_definitions(PLANISH_ASSERTS)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
