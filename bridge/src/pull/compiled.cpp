// One road user's state through the C++ functions that libsumo's Python module itself calls and exports.
//
// libsumo's headers are not part of its wheel: what is needed of them is declared here, and the caller compares what
// comes of it with what Python's getters say (getters.rs).

#include <dlfcn.h>

#include <cstddef>
#include <string>

// GNU's std::string as GCC has it since version 5: the names below are of functions that take this one.
#if !defined(__GLIBCXX__) || !_GLIBCXX_USE_CXX11_ABI
#error "needs GNU's C++ library with the strings of C++11"
#endif

namespace {

// libsumo::TraCIPosition: a class with virtual functions and three numbers (libsumo/TraCIDefs.h). A function returns
// it into its caller's memory, so a libsumo whose positions hold more still finds room.
struct Position {
    void* table;
    double x, y, z;
    double room[28];
};

using PositionOf = Position (*)(const std::string& id, bool with_height);
using NumberOf = double (*)(const std::string& id);
using NameOf = std::string (*)(const std::string& id);

}  // namespace

extern "C" {

// Functions of libsumo; `inside` is null where road users are inside nobody, `route` where they have none.
struct ClosecallGetters {
    PositionOf position;
    NumberOf angle;
    NumberOf speed;
    NameOf inside;
    NameOf route;
};

struct ClosecallReading {
    double x, y, z;
    double angle;
    double speed;
    bool is_inside;
};

// Finds the functions of "7Vehicle" or "6Person" in the module that is loaded from this file; false if one is missing.
// The module is held from then on: it stays loaded as long as the process lives.
bool closecall_find(const char* file, const char* domain, bool may_be_inside, ClosecallGetters* getters) noexcept {
    void* const module = dlopen(file, RTLD_NOW | RTLD_NOLOAD);
    if (module == nullptr) {
        return false;
    }
    try {
        const auto find = [&](const char* name, const char* more) {
            const std::string string = "ERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE";
            return dlsym(module, (std::string("_ZN7libsumo") + domain + name + string + more).c_str());
        };
        getters->position = reinterpret_cast<PositionOf>(find("11getPosition", "b"));
        getters->angle = reinterpret_cast<NumberOf>(find("8getAngle", ""));
        getters->speed = reinterpret_cast<NumberOf>(find("8getSpeed", ""));
        getters->inside = may_be_inside ? reinterpret_cast<NameOf>(find("10getVehicle", "")) : nullptr;
        getters->route = may_be_inside ? nullptr : reinterpret_cast<NameOf>(find("10getRouteID", ""));
    } catch (...) {
        return false;
    }
    return getters->position && getters->angle && getters->speed && (may_be_inside ? getters->inside : getters->route);
}

// The state of the road user of this id; false if libsumo throws, as it does for an id that it does not know. Of who is
// inside somebody else only that is read.
bool closecall_read(const ClosecallGetters* getters, const char* id, size_t length, ClosecallReading* reading) noexcept {
    try {
        const std::string name(id, length);
        reading->is_inside = getters->inside != nullptr && !getters->inside(name).empty();
        if (reading->is_inside) {
            return true;
        }
        const Position position = getters->position(name, true);
        reading->x = position.x;
        reading->y = position.y;
        reading->z = position.z;
        reading->angle = getters->angle(name);
        reading->speed = getters->speed(name);
        return true;
    } catch (...) {
        return false;
    }
}

// Whether the road user of this id has the route of that id; false too if libsumo throws.
bool closecall_has_route(const ClosecallGetters* getters, const char* id, size_t length, const char* route,
                         size_t route_length) noexcept {
    try {
        return getters->route != nullptr &&
               getters->route(std::string(id, length)).compare(0, std::string::npos, route, route_length) == 0;
    } catch (...) {
        return false;
    }
}
}
