#pragma once

#ifdef SHADOWCACHE_TUNABLE
namespace shadowcache {

/// Value of the environment variable SHADOWCACHE_<name>, or `value` where there is none. A variable
/// that is no number ends the program.
double tunedValue(const char* name, double value);

}  // namespace shadowcache
#endif

/// A constant that was chosen by measurement or judgement: it decides about error and cost, and no
/// format, limit or formula fixes it. Its name is unique in the project. docs/constants.md lists
/// all of them with the effect of half and twice the value. Preceded by `inline` in a header, by
/// `static` in a function, by `inline static` in a class.
///
/// In a build with -D SHADOWCACHE_TUNABLE=ON its value comes from the environment when the program
/// starts; in all others it is a constexpr.
#ifdef SHADOWCACHE_TUNABLE
#define SHADOWCACHE_TUNED(Type, name, value) \
    const Type name =                        \
        static_cast<Type>(::shadowcache::tunedValue(#name, static_cast<double>(value)))
#else
#define SHADOWCACHE_TUNED(Type, name, value) constexpr Type name = value
#endif
