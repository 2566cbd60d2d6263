// Where there is no driver, the installed fleet says so in a sentence.
#include <rlslab/gpu/fleet.hpp>
#include <rlslab/variants/ud.hpp>

#include <iostream>

int main() {
    try {
        rlslab::gpu::Fleet<rlslab::Ud<double>> fleet(2, {.size = 1});
        fleet.update(rlslab::Matrix<double>::Ones(2, 1), rlslab::Vector<double>::Ones(2));
        return fleet.filter(1).theta()[0] > 0.99 ? 0 : 1;
    } catch (std::runtime_error const& absent) {
        std::cout << absent.what() << '\n';
        return *absent.what() ? 0 : 1;
    }
}
