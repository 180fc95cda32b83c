// Compiles the file named HWY_TARGET_INCLUDE once for each of the machines; the one to run is chosen at run
// time. No include guard: Highway passes through here once a target.
#include <hwy/foreach_target.h>
// after it
#include <hwy/highway.h>
