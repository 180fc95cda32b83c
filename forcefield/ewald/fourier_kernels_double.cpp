#define TAUT_FOURIER_REAL double
#include "forcefield/ewald/fourier_kernels-inl.hpp"
