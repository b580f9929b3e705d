/* clang-tidy reads every file as if it began with this. The analyzer sees one file at a time, so it would follow paths
 * on which hewn_fail() returns HEWN_OK or luaL_error() returns at all; here it is told. */
#if __has_include("base/error.h")
#include "base/error.h"
#define hewn_fail(error, code, ...) (hewn_fail(error, code, __VA_ARGS__), (code))
#define hewn_fail_at(error, code, ...) (hewn_fail_at(error, code, __VA_ARGS__), (code))
#endif
#define luaL_error(...) (luaL_error(__VA_ARGS__), __builtin_unreachable(), 0)
