// Every variant in every arithmetic, by the installed catalogue: alone, composed, saved and loaded.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>

#include <cmath>
#include <cstdio>

namespace {

using namespace rlslab;

/// Whether the filter finds y = 3 + 2 x, about (`information` in 11 bits does not), and a copy of its state goes on as
/// it does.
bool finds_the_line(AnyFilter& filter, AnyFilter& other, Arithmetic const& arithmetic) {
    for (int k = 0; k < 200; ++k) {
        double const x = k % 16 / 8.0;
        filter.update({1.0, x}, 3 + 2 * x);
    }
    other.load(filter.saved());
    auto const theta = filter.theta();
    return theta == other.theta() && (arithmetic.digits < 24 || std::abs(static_cast<double>(theta[1]) - 2) < 0.1);
}

}  // namespace

int main() {
    Problem<double> const problem{.size = 2};
    int wrong = 0;
    for (CatalogueEntry const& entry : catalogue())
        if (!finds_the_line(*entry.make(problem, Seed{1}), *entry.make(problem, Seed{1}), *entry.arithmetic)) {
            std::printf("wrong: %s in %s\n", entry.variant.data(), entry.arithmetic->name.data());
            ++wrong;
        }
    Composition const composition{.window = 50, .guard = "reset"};
    Arithmetic const& in_double = *find_entry("ud")->arithmetic;
    wrong += !finds_the_line(*composed(composition, "ud", "double", problem),
                             *composed(composition, "ud", "double", problem), in_double);
    std::printf("%zu filters, %d wrong\n", catalogue().size() + 1, wrong);
    return wrong == 0 ? 0 : 1;
}
