// The table of formulas where there is no pandoc: pages show them as text.
namespace rlslab::report {

extern char const* const formulas[][2];
char const* const formulas[][2] = {{}};

}  // namespace rlslab::report
