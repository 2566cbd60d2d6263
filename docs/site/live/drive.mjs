// Drives the live page in Chromium with the network off, and compares its bits with the native program's.
// usage: node drive.mjs FOLDER [--pictures]    FOLDER: where build.py left index.html and facts.json
import { spawn, spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const folder = path.resolve(process.argv[2]), facts = JSON.parse(fs.readFileSync(path.join(folder, "facts.json")));
const profile = fs.mkdtempSync(path.join(os.tmpdir(), "rlslab-live-"));
const chromium = spawn("chromium", ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe",
  "--no-first-run", "--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND",
  `--user-data-dir=${profile}`, "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
const left = { text: "" }, waiting = new Map(), faults = [], requests = [];
let nextId = 0, session;
chromium.stdio[4].on("data", chunk => {
  const messages = (left.text + chunk).split("\0");
  left.text = messages.pop();
  for (const message of messages.map(m => JSON.parse(m))) {
    if (message.id) {
      waiting.get(message.id)(message);
      waiting.delete(message.id);
    } else heard(message);
  }
});
const send = (method, params = {}) => new Promise((answered, failed) => {
  waiting.set(++nextId, m => m.error ? failed(new Error(`${method}: ${m.error.message}`)) : answered(m.result));
  chromium.stdio[3].write(JSON.stringify({ id: nextId, method, params, sessionId: session }) + "\0");
});
function heard({ method, params }) {
  if (method === "Runtime.exceptionThrown") faults.push(params.exceptionDetails.exception?.description ||
                                                        params.exceptionDetails.text);
  if (method === "Runtime.consoleAPICalled" && ["error", "warning"].includes(params.type))
    faults.push(params.args.map(a => a.value || a.description).join(" "));
  if (method === "Log.entryAdded" && params.entry.level === "error") faults.push(params.entry.text);
  if (method === "Network.requestWillBeSent") requests.push(params.request.url);
}
async function evaluate(expression) {
  const { result, exceptionDetails } = await send("Runtime.evaluate",
    { expression, awaitPromise: true, returnByValue: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description || exceptionDetails.text);
  return result.value;
}
const pause = ms => new Promise(done => setTimeout(done, ms));
async function until(expression, seconds = 120) {    // much, for a busy machine
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await pause(20))
    if (await evaluate(expression)) return;
  throw new Error(`not within ${seconds} s: ${expression}`);
}
const done = () => until("!dirty && !computing && asked === 0");
let checks = 0;
function check(holds, what) {
  ++checks;
  if (!holds) faults.push(what);
}

async function open(hash = "", page = "index.html") {
  await send("Page.navigate", { url: "about:blank" });
  await send("Page.navigate", { url: pathToFileURL(path.join(folder, page)).href + hash });
  await until("document.body && document.body.dataset.ready === 'yes'");
  await done();
}
async function hashes() {
  let equal = 0, all = 0;
  for (const one of facts.hashes) {
    await evaluate(`location.hash = ${JSON.stringify("#" + new URLSearchParams(one.settings))}`);
    await until(`shown && ${JSON.stringify(Object.entries(one.settings))}.every(([n, x]) => page.values[n] === x)`);
    await done();
    const found = await evaluate("Object.fromEntries(variants.map((v, i) => [v.name, hashOf(shown.summaries[i])]))");
    for (const [variant, hash] of Object.entries(one.hashes)) {
      ++all;
      equal += found[variant] === hash;
      check(found[variant] === hash, `${variant} at ${JSON.stringify(one.settings)}: other bits than natively`);
    }
  }
  console.log(`hashes of theta after every row: ${equal} of ${all} equal the native program's`);
}
async function controls() {
  await open();
  const names = await evaluate("settings.filter(s => words[s.name]).map(s => s.name)");
  for (const name of names) {
    for (const end of ["least", "most", "start"]) {
      await evaluate(`{ const s = settings.find(s => s.name === "${name}"), e = byId("set-${name}");
        e.type === "checkbox" ? e.checked = s["${end}"] !== 0 : e.value = s["${end}"];
        e.dispatchEvent(new Event("input", { bubbles: true })); }`);
      await done();
      check(await evaluate(`page.values["${name}"] === settings.find(s => s.name === "${name}")["${end}"] &&
        byId("status").className === "" && shown.taken === page.values.rows`), `${name} at its ${end}`);
    }
  }
  for (let i = 0; i < await evaluate("byId('stories').children.length"); ++i) {
    await evaluate(`byId("stories").children[${i}].click()`);
    await pause(50);
    await done();
    check(await evaluate("byId('status').className === ''"), `example ${i}`);
  }
  const unlabelled = await evaluate(`[...document.querySelectorAll("input, select, button")].filter(e =>
    !e.labels?.length && !e.textContent.trim() && !e.getAttribute("aria-label")).map(e => e.id)`);
  check(unlabelled.length === 0, `without a label: ${unlabelled}`);
  console.log(`${names.length} controls moved to both ends and back`);
}
async function links() {
  await open();
  check(await evaluate("svg(1)") === fs.readFileSync("docs/live.svg", "utf8"),
    "docs/live.svg is not what the page draws: ./lab live --pictures leaves it in build/live");
  await open("#bits=12&lambda=0.95&variants=ud%2Cqr&variant=ud&outlier=1&bogus=9&rows=1e9&noise=x&guard=2");
  check(await evaluate(`page.values.bits === 12 && page.values.lambda === 0.95 && page.values.outlier === 1 &&
    page.values.guard === 2 && byId("set-guard").selectedOptions[0].text === "rebuild" &&
    page.values.rows === 2000 && page.values.noise === 0.1 && [...page.chosen].join() === "ud,qr" &&
    page.focus === "ud"`), "a link with settings");
  const link = await evaluate("link()"), before = await evaluate("shown.summaries.map(s => hashOf(s))");
  await open(link);
  check(JSON.stringify(await evaluate("shown.summaries.map(s => hashOf(s))")) === JSON.stringify(before),
    "a copied link opens the same page");
  check(/guard=2/.test(link), `the guard in a link: ${link}`);
  check(await evaluate("!document.querySelector('#table a') && byId('home').hidden"), "alone, the page leads nowhere");
  check((await evaluate("csv()")).split("\n").length === 2002, "the numbers as CSV");
  check(/^<svg [\s\S]*<path [\s\S]*<\/svg>\n$/.test(await evaluate("svg()")) &&
    await evaluate(`!new DOMParser().parseFromString(svg(), "image/svg+xml").querySelector("parsererror")`),
    "the picture as SVG");
}
/** As docs/site/build.py has it, in a folder: what leads to other pages does. */
async function site() {
  const alone = fs.readFileSync(path.join(folder, "index.html"), "utf8");
  const texts = { "index.html": "<title>first</title>", "variants/ud.html": "<title>ud</title>",
                  "live/index.html": alone.replace('data-variants=""', 'data-variants="../variants/"') };
  for (const [name, text] of Object.entries(texts)) {
    const to = path.join(folder, "site", name);
    fs.mkdirSync(path.dirname(to), { recursive: true });
    fs.writeFileSync(to, text);
  }
  for (const [link, title] of [["#home", "first"], ["#table a[href$='/ud.html']", "ud"]]) {
    await open("#variants=ud", "site/live/index.html");
    await until(`document.querySelector("${link}")`);    // the table comes with the first answer
    await evaluate(`document.querySelector("${link}").click()`);
    await until("document.readyState === 'complete' && document.title !== '' && !document.title.startsWith('rlslab')");
    check(await evaluate("document.title") === title, `on a site, ${link} leads to ${await evaluate("location.href")}`);
  }
}
async function records() {
  for (const r of facts.records) {
    await open(`#record=${r.name}&bits=53`);
    const digits = await evaluate("certifiedDigits(variants.length)"), carried = await evaluate("shown.carried()");
    check(digits >= Math.min(28, carried), `${r.name}: the reference has ${digits} digits and claims ${carried}`);
    console.log(`${r.name}: ${await evaluate("shown.taken")} rows; the reference agrees with the certified answer in ` +
      `${digits.toFixed(1)} digits and claims ${Math.floor(carried)}`);
  }
}
async function drop(content, name = "mine.csv") {
  await evaluate(`{ byId("own-message").textContent = "";
    const carried = new DataTransfer();
    carried.items.add(new File([${JSON.stringify(content)}], "${name}", { type: "text/csv" }));
    window.dispatchEvent(new DragEvent("drop", { dataTransfer: carried, bubbles: true })); }`);
  await until("byId('own-message').textContent !== ''");
  await done();
  return evaluate("byId('own-message').textContent");
}
async function files() {
  await open();
  const rows = Array.from({ length: 80 }, (_, k) => `${k};${Math.sin(k).toFixed(4).replace(".", ",")};${
    k % 9 ? (3 + Math.cos(3 * k)).toFixed(3).replace(".", ",") : ""};x`);
  const words = await drop(`time;u;y;remark\n${rows.join("\n")}\n`);
  check(words.startsWith("71 rows of 3 parameters; 9 skipped"), `a dropped file: ${words}`);
  check(await evaluate(`shown.taken === 71 && byId("model").querySelectorAll(".inputs input").length === 4`),
    "the rows of a dropped file");
  for (const [content, expected] of [["", "found no row"], ["a,b\n", "found none"], ["a,b\n1,2,3\n", "found 3"],
    ["a,b\nx,y\nz,w\n", "found none"], ["a,b\nNaN,1\nNaN,2\n", "at least"], ["1,1e300\n2,3\n", "expected"],
    ["\0\xff\n<b>\n", "expected"]]) {
    const said = await drop(content);
    check(said.includes(expected), `${JSON.stringify(content)}: ${said}`);
  }
  check((await drop("u,y\n" + "1.234567,2.345678\n".repeat(1e6))).startsWith("20000 rows"), "a file of 18 MB");
  check((await drop("y\n" + "1\n2\n4\n3\n".repeat(9))).startsWith("36 rows of 1 parameter"), "a file of one column");
  await drop("u,y\n" + Array.from({ length: 50 }, (_, k) => `${k % 7},${k % 5}`).join("\n"));
  // What is to be pasted: C++ that compiles, Python that parses.
  for (const [bits, guard, rounding] of [[24, 0, 0], [53, 1, 0], [11, 2, 2]]) {
    await evaluate(`Object.assign(page.values, { bits: ${bits}, guard: ${guard}, rounding: ${rounding} })`);
    const cpp = path.join(folder, `code_${bits}.cpp`), python = path.join(folder, `code_${bits}.py`);
    fs.writeFileSync(cpp, await evaluate(`program("cpp")`));
    fs.writeFileSync(python, await evaluate(`program("python")`));
    const policy = [null, "reset", "rebuild"][guard], named = [`rlslab::${policy === "reset" ? "resetting"
      : "rebuilding"}>`, `guard="${policy}"`];
    for (const [i, file] of [cpp, python].entries())
      check(fs.readFileSync(file, "utf8").includes(named[i]) === (guard > 0), `${file}: guard ${policy}`);
    for (const words of [["g++", "-std=c++20", "-ffp-contract=off", "-Wall", "-Wextra", "-fsyntax-only", "-isystem",
                          "/usr/include/eigen3", "-I", "src", cpp],
                         ["python3", "-c", "import ast, sys; ast.parse(open(sys.argv[1]).read())", python]]) {
      const { status, stderr } = spawnSync(words[0], words.slice(1), { encoding: "utf8" });
      check(status === 0 && !stderr, `${words[0]}: ${stderr}`);
    }
  }
}
async function frames() {
  await open("#parameters=6&bits=24");
  await evaluate(`byId("pace").value = "100"; play(true)`);
  await until("meter.last !== null", 25);
  const { frames, rows, seconds } = await evaluate("meter.last");
  await evaluate("play(false)");
  console.log(`d = 6, ${await evaluate("variants.length")} variants: ${frames.toFixed(1)} frames and ` +
    `${rows.toFixed(0)} rows a second over ${seconds.toFixed(1)} s: ${(rows / frames).toFixed(0)} rows a frame`);
}
async function pictures() {
  for (const width of [1280, 420])
    for (const scheme of ["light", "dark"]) {
      await send("Emulation.setDeviceMetricsOverride",
        { width, height: 900, deviceScaleFactor: 1, mobile: width < 500 });
      await send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: scheme }] });
      await open();
      await pause(300);
      check(await evaluate("document.documentElement.scrollWidth <= innerWidth"), `${width} px: wider than the window`);
      const { data } = await send("Page.captureScreenshot", { captureBeyondViewport: true });
      fs.writeFileSync(path.join(folder, `live_${width}_${scheme}.png`), Buffer.from(data, "base64"));
      if (width > 500 && scheme === "light")    // README's
        fs.writeFileSync(path.join(folder, "live.svg"), await evaluate("svg(1)"));
    }
}

try {
  const { targetInfos } = await send("Target.getTargets");
  const { targetId } = targetInfos.find(t => t.type === "page");
  session = (await send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
  for (const domain of ["Page", "Runtime", "Log", "Network"]) await send(`${domain}.enable`);
  if (process.argv.includes("--pictures")) await pictures();
  else {
    await open();
    await hashes();
    await controls();
    await links();
    await site();
    await records();
    await files();
    await frames();
  }
  for (const url of requests) check(/^(file|blob|data|about):/.test(url), `a request: ${url}`);
} catch (e) {
  faults.push(e.message);
}
chromium.kill();
await new Promise(done => chromium.on("exit", done));
fs.rmSync(profile, { recursive: true, force: true });
for (const fault of faults) console.error(`fault: ${fault}`);
console.log(`${checks} checks, ${requests.length} local loads, ${faults.length} faults`);
process.exit(faults.length ? 1 : 0);
