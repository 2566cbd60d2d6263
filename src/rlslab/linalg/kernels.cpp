// The library rlslab::kernels: every kernel of one scalar, RLSLAB_KERNELS_OF, and what a filter of it starts from, for
// the files that are compiled with RLSLAB_COMPILED_KERNELS. Whoever adds a kernel adds a line here: the linker names
// what is missing.
#undef RLSLAB_COMPILED_KERNELS
#include <rlslab/linalg/start.hpp>

#define RLSLAB_COMPILE(...) template void dispatch<T>(__VA_ARGS__ const&);

namespace rlslab::kernels {

using T = RLSLAB_KERNELS_OF;
RLSLAB_COMPILE(DivideByOne<T>)
RLSLAB_COMPILE(Divide<T>)
RLSLAB_COMPILE(Scale<T>)
RLSLAB_COMPILE(SquareRoots<T>)
RLSLAB_COMPILE(AddScaled<T>)
RLSLAB_COMPILE(ScaleByOne<T>)
RLSLAB_COMPILE(Add<T>)
RLSLAB_COMPILE(AddProduct<T>)
RLSLAB_COMPILE(PrefixSums<T>)
RLSLAB_COMPILE(AllFinite<T>)
RLSLAB_COMPILE(MultiplySquares<T>)
RLSLAB_COMPILE(Multiply<T>)
RLSLAB_COMPILE(SubtractRankOne<T>)
RLSLAB_COMPILE(AddSquare<T>)
RLSLAB_COMPILE(OnBlocks<Multiply<T>>)
RLSLAB_COMPILE(OnBlocks<SubtractRankOne<T>>)
RLSLAB_COMPILE(OnBlocks<AddSquare<T>>)
RLSLAB_COMPILE(SubtractRankTwo<T>)
RLSLAB_COMPILE(SweepUd<T>)
RLSLAB_COMPILE(SweepCarlson<T>)
RLSLAB_COMPILE(SweepRotations<T>)
RLSLAB_COMPILE(SweepCarlsonDelta<T>)
RLSLAB_COMPILE(SweepRotationsDelta<T>)
RLSLAB_COMPILE(Eliminate<T>)
RLSLAB_COMPILE(SolveLower<T>)
RLSLAB_COMPILE(SweepGentleman<T>)
RLSLAB_COMPILE(FoldGentleman<T>)
RLSLAB_COMPILE(SolveRotations<T>)
RLSLAB_COMPILE(FoldQr<T>)
RLSLAB_COMPILE(RotateIn<T>)
RLSLAB_COMPILE(RotateOut<T>)
RLSLAB_COMPILE(ReflectIn<T>)
RLSLAB_COMPILE(RotateInRows<T>)
RLSLAB_COMPILE(SumOfSquares<T>)
RLSLAB_COMPILE(Division<T>)
RLSLAB_COMPILE(Reflection<T>)
RLSLAB_COMPILE(ReflectPanel<T>)
RLSLAB_COMPILE(SubtractProduct<T>)
RLSLAB_COMPILE(MultiplyTransposed<T, Shape::full>)
RLSLAB_COMPILE(MultiplyTransposed<T, Shape::upper>)
RLSLAB_COMPILE(ThenMultiply<SubtractRankOne<T>>)
RLSLAB_COMPILE(ThenMultiply<SweepUd<T>>)
RLSLAB_COMPILE(ThenMultiply<SweepCarlson<T>>)
RLSLAB_COMPILE(ThenMultiply<SweepRotations<T>>)

}  // namespace rlslab::kernels

namespace rlslab {

using kernels::T;
template Problem<T> const& checked(Problem<T> const&, int);
template StateVector<T> start_theta(Problem<T> const&);
template StateMatrix<T> start_covariance(Problem<T> const&);
template StateMatrix<T> start_root(Problem<T> const&);
template void start_ud(Problem<T> const&, StateMatrix<T>&, StateVector<T>&);
template void start_information(Problem<T> const&, StateMatrix<T>&, StateVector<T>&);
template void start_information_root(Problem<T> const&, StateMatrix<T>&, StateVector<T>&);

}  // namespace rlslab
