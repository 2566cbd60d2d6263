// The filter that is set, as a program: C++ or Python to paste.

const className = name => name.split("_").map(w => w[0].toUpperCase() + w.slice(1)).join("");

/** Words in lines of a given width; `mark` begins the first, `next` the others. */
function inLines(mark, next, list) {
  const lines = [mark];
  for (const word of list) {
    if ((lines[lines.length - 1] + word).length > 90) lines.push(next);
    lines[lines.length - 1] += " " + word;
  }
  return lines.join("\n");
}
const listed = list => list.map((word, i) => word + (i + 1 < list.length ? "," : ""));
/** f: variant, d, bits, exponents (bits; 10: double's), rounding, lambda, prior (of P0, scaled), names of the
 *  regressors (null: rows are made), scales, output, guard (null, or its name and constant). */
function programOf(language, f) {
  const d = f.d, scaled = f.scales.some(s => s !== 1), p0 = f.scales.map(s => f.prior / (s * s));
  const list = f.names ? ["a row:", ...listed(f.names), `and y = ${f.output}`]
    : [`a row: psi, ${d} numbers, and y`];
  const hardware = f.bits === 53 ? ["double", "float64"] : f.bits === 24 && f.exponents >= 8 && f.rounding === 0
    ? ["float", "float32"] : null;
  if (language === "python") {
    const precision = hardware ? "" : "# The page rounds to " + words.format(f) +
      "; Python has float64 and float32.\n";
    const type = (hardware || ["double", "float64"])[1];
    const guard = f.guard ? `, guard="${f.guard.name}"` : "";
    const prior = scaled ? `np.diag([${p0.join(", ")}])` : f.prior;
    return `import numpy as np
import rlslab

${precision}${inLines("#", "#   ", list)}
f = rlslab.filter("${f.variant}", ${d}, forgetting=${f.lambda}, ` +
      `${scaled ? "prior_covariance" : "prior_variance"}=${prior}, dtype="${type}"${guard})
steps = f.update_many(Psi, y, steps=True)   ` +
      `# Psi: a row for each y, ${d} columns
print(f.theta)
`;
  }
  const type = hardware ? hardware[0] : "rlslab::VariablePrecision", name = `rlslab::${className(f.variant)}<T>`;
  const scope = hardware ? "" : `    // ${words.format(f)}
    rlslab::Format const format{${f.bits}, ${f.exponents === 10 ? "-1022, 1023"
      : `${2 - 2 ** (f.exponents - 1)}, ${2 ** (f.exponents - 1) - 1}`}};
    rlslab::PrecisionScope const scope({format, rlslab::Rounding::${
      ["nearest", "toward_zero", "stochastic"][f.rounding]}});
${f.rounding === 2 ? "    rlslab::Seed seed{1};\n    rlslab::StochasticStream const stream(seed);\n" : ""}`;
  const covariance = scaled ? `    rlslab::Vector<T> p0(${d});
${inLines("    p0 <<", "       ", listed(p0.map(v => `T(${v})`)))};
    problem.prior->covariance = rlslab::Matrix<T>(p0.asDiagonal());` : `    problem.prior->variance = T(${f.prior});`;
  return `${f.guard ? "#include <rlslab/adapt/guard.hpp>\n" : ""}${hardware ? ""
    : "#include <rlslab/arithmetic/variable_precision.hpp>\n"}#include <rlslab/variants/${f.variant}.hpp>

using T = ${type};

int main() {
${scope}    rlslab::Problem<T> problem{.size = ${d}, .forgetting = T(${f.lambda})};
${covariance}
    ${f.guard ? `rlslab::Guarded<${name}, rlslab::${f.guard.constant}>` : name} filter(problem);

${inLines("    //", "    //   ", list)}
    rlslab::Vector<T> psi = rlslab::Vector<T>::Zero(${d});
    T const y = T(0);
    auto const step = filter.update(psi, y);   // step.innovation, step.health
    return step.health == rlslab::Health::sound ? 0 : 1;   // filter.theta() is the estimate
}
`;
}
