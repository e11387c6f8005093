#pragma once

#include <atomic>

namespace corda {

/// A function of a library that is loaded when the function is first called. `kFind` gives the address of a
/// function by its name; what it throws, the call throws.
template <void* (*kFind)(const char*), class Result, class... Arguments>
class LoadedFunction {
  public:
    constexpr explicit LoadedFunction(const char* name) : name_(name) {}

    Result operator()(Arguments... arguments) const {
        Pointer function = function_;
        if (function == nullptr) function_ = function = reinterpret_cast<Pointer>(kFind(name_));
        return function(arguments...);
    }

  private:
    using Pointer = Result (*)(Arguments...);

    const char* name_;
    mutable std::atomic<Pointer> function_ = nullptr;
};

/// Without a definition: gives the type for a function.
template <void* (*kFind)(const char*), class Result, class... Arguments>
LoadedFunction<kFind, Result, Arguments...> loaded_function(Result (*)(Arguments...));

}  // namespace corda
