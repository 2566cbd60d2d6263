# Where the packages of the benchmarks' peers are installed; what is not found is NOTFOUND.
find_library(OPENBLAS_LIBRARY openblas)
find_path(DLIB_INCLUDE_DIR dlib/svm/rls.h)
find_library(DLIB_LIBRARY dlib)
find_path(LIQUID_INCLUDE_DIR liquid/liquid.h)
find_library(LIQUID_LIBRARY liquid)
find_library(SLICOT_LIBRARY slicot)
mark_as_advanced(OPENBLAS_LIBRARY DLIB_INCLUDE_DIR DLIB_LIBRARY LIQUID_INCLUDE_DIR LIQUID_LIBRARY SLICOT_LIBRARY)
