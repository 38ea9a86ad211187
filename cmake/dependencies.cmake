# Every dependency of planish, all from the distribution. The Debian packages stand in one place: cmake/packages.txt.
find_package(TBB 2021 REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(CGAL 5.5 REQUIRED)
find_package(tl-expected REQUIRED)
find_package(fmt REQUIRED)
find_package(FastFloat REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)

# The sparse Cholesky factorization that tests and benchmarks compare with; the library does not link it.
if(PLANISH_TESTS OR PLANISH_PERF)
  find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
  find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
  add_library(planish_cholmod INTERFACE)
  target_include_directories(planish_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
  target_link_libraries(planish_cholmod INTERFACE ${CHOLMOD_LIBRARY})
endif()

# Embree 4 where there is one, else 3: the source tells them apart by the header that is found.
find_path(EMBREE_INCLUDE_DIR NAMES embree4/rtcore.h embree3/rtcore.h REQUIRED)
if(EXISTS ${EMBREE_INCLUDE_DIR}/embree4/rtcore.h)
  find_library(EMBREE_LIBRARY embree4 REQUIRED)
else()
  find_library(EMBREE_LIBRARY embree3 REQUIRED)
endif()
add_library(planish_embree INTERFACE)
target_include_directories(planish_embree SYSTEM INTERFACE ${EMBREE_INCLUDE_DIR})
target_link_libraries(planish_embree INTERFACE ${EMBREE_LIBRARY})

# What the library's objects link to; none of it shows in a public header but tl-expected.
add_library(planish_third_party INTERFACE)
target_link_libraries(planish_third_party INTERFACE TBB::tbb planish_embree ZLIB::ZLIB fmt::fmt PkgConfig::CAIRO
                                                    ${CMAKE_DL_LIBS})
if(PLANISH_WITH_CGAL_GPL)
  target_link_libraries(planish_third_party INTERFACE CGAL::CGAL)
endif()
