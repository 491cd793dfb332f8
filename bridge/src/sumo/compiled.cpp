// One road user's state through the C++ functions that libsumo's Python module itself calls and exports; with a SUMO
// that is known, through those that these call once they have looked up its id: one look-up instead of three or four.
//
// libsumo's headers are not part of its wheel: what is needed of them is declared here, and the caller compares what
// comes of it with what Python's getters say (getters.rs).

#include <dlfcn.h>

#include <cstddef>
#include <string>
#include <type_traits>

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

// SUMO's Position: three numbers (utils/geom/Position.h), returned in the same way.
struct Point {
    double x, y, z;
    double room[29];
};

// A vehicle or person of SUMO's: one address for MSVehicle, or MSTransportable, and the classes that it is derived from,
// each from the next alone.
using User = const void*;

// libsumo::INVALID_DOUBLE_VALUE.
constexpr double INVALID = -1073741824.0;

}  // namespace

extern "C" {

// What libsumo's getters call; `is_visible` is null for persons, `activity` for vehicles.
struct ClosecallDirect {
    User (*find)(const std::string& id);
    bool (*is_visible)(User vehicle);
    std::string (*activity)(User person);
    Point (*position)(User user, double offset);
    double (*heading)(User user);
    double (*degrees)(double heading);
    double (*speed)(User user);
};

// Functions of libsumo; `inside` is null where road users are not inside others, `route` where they have none, those of
// `direct` where they are not to be called.
struct ClosecallGetters {
    PositionOf position;
    NumberOf angle;
    NumberOf speed;
    NameOf inside;
    NameOf route;
    ClosecallDirect direct;
};

struct ClosecallReading {
    double x, y, z;
    double angle;
    double speed;
    bool is_inside;
};

}  // extern "C"

namespace {

// All of them, or none.
ClosecallDirect find_direct(void* module, bool of_persons) {
    ClosecallDirect direct{};
    bool has_all = true;
    const auto find = [&](auto& function, const char* name) {
        void* const found = dlsym(module, name);
        function = reinterpret_cast<typename std::remove_reference<decltype(function)>::type>(found);
        has_all = has_all && found != nullptr;
    };
    find(direct.degrees, "_ZN10GeomHelper10naviDegreeEd");
    if (of_persons) {
        find(direct.find, "_ZN7libsumo6Helper9getPersonERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE");
        find(direct.activity, "_ZNK15MSTransportable26getCurrentStageDescriptionB5cxx11Ev");
        find(direct.position, "_ZNK15MSTransportable11getPositionEd");
        find(direct.heading, "_ZNK15MSTransportable8getAngleEv");
        find(direct.speed, "_ZNK15MSTransportable8getSpeedEv");
    } else {
        find(direct.find, "_ZN7libsumo6Helper10getVehicleERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE");
        find(direct.is_visible, "_ZN7libsumo7Vehicle9isVisibleEPK11SUMOVehicle");
        find(direct.position, "_ZNK9MSVehicle11getPositionEd");
        find(direct.heading, "_ZNK9MSVehicle8getAngleEv");
        find(direct.speed, "_ZNK9MSVehicle8getSpeedEv");
    }
    return has_all ? direct : ClosecallDirect{};
}

// Whether a vehicle has departed: a waiting vehicle may be deleted without arriving. SUMO always reports a person as arrived.
bool is_there(const ClosecallDirect& direct, User user) {
    return direct.is_visible == nullptr || direct.is_visible(user);
}

// What libsumo's getters return for a road user.
void read_directly(const ClosecallDirect& direct, User user, ClosecallReading* reading) {
    // The stage of a ride says "driving" where it has a vehicle, else "waiting for" it; no other stage has one.
    reading->is_inside = direct.activity != nullptr && direct.activity(user) == "driving";
    if (reading->is_inside) {
        return;
    }
    if (!is_there(direct, user)) {
        *reading = {INVALID, INVALID, INVALID, INVALID, INVALID, false};
        return;
    }
    const Point position = direct.position(user, 0);
    *reading = {position.x, position.y, position.z, direct.degrees(direct.heading(user)), direct.speed(user), false};
}

}  // namespace

extern "C" {

// Finds the functions of "7Vehicle" or "6Person" in the module that is loaded from this file; false if one is missing.
// The module is held from then on: it stays loaded as long as the process lives. `is_known` says that this SUMO's
// functions behind libsumo's are what is declared here.
bool closecall_find(const char* file, const char* domain, bool may_be_inside, bool is_known,
                    ClosecallGetters* getters) noexcept {
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
        getters->direct = ClosecallDirect{};
        if (is_known) {
            getters->direct = find_direct(module, may_be_inside);
        }
    } catch (...) {
        return false;
    }
    return getters->position && getters->angle && getters->speed && (may_be_inside ? getters->inside : getters->route);
}

// The state of the road user of this id; false if libsumo throws, as it does for an id that it does not know. For a road
// user inside another, only that is read. Where `kept` is not null, it holds where the road user is found without its id
// while it is there, or null before it is found.
bool closecall_read(const ClosecallGetters* getters, const char* id, size_t length, User* kept,
                    ClosecallReading* reading) noexcept {
    try {
        if (getters->direct.find != nullptr) {
            User user = kept != nullptr ? *kept : nullptr;
            if (user == nullptr) {
                user = getters->direct.find(std::string(id, length));
                if (kept != nullptr && is_there(getters->direct, user)) {
                    *kept = user;
                }
            }
            read_directly(getters->direct, user, reading);
            return true;
        }
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
