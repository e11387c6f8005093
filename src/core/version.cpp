#include "corda/core/version.hpp"

namespace corda {

std::string_view version() {
    return CORDA_VERSION;
}

}  // namespace corda
