// Judge of vpost.html: programs corrected in the page, in Chromium and in Firefox, against the command's bytes.
//
//     node --experimental-websocket tests/page/judge.mjs --vpost target/release/vpost --page target/page/vpost.html \
//         --machine machine-profiles/stan_s500.toml --dialect linuxcnc [--browser firefox] [--speed BIG.nc] PROGRAM…
//
// The page is opened from the disk and gets its files by its own input. Status, program and summary must be the command's;
// the page may ask the network for nothing and say nothing to the console; no task on its own thread may last longer than
// 50 ms (Chromium tells). Exit status 1 where one of these does not hold.

import { execFileSync, spawnSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";
import { parseArgs } from "node:util";

import { browsers } from "./browsers.mjs";

const LONGEST_MS = 50;
/** A program that takes the command longer than this is none for a page, ms. */
const PATIENCE = 300_000;

const { values: given, positionals: programs } = parseArgs({
  allowPositionals: true,
  options: {
    vpost: { type: "string" },
    page: { type: "string" },
    machine: { type: "string" },
    dialect: { type: "string" },
    browser: { type: "string", multiple: true, default: ["chromium", "firefox"] },
    speed: { type: "string", multiple: true, default: [] },
  },
});

/** Waits in the page. */
async function wait(browser, script, seconds = 120) {
  const come = await browser.evaluate(`new Promise((done) => {
    const look = () => { try { if (${script}) return done(true); } catch {} setTimeout(look, 20); };
    look();
    setTimeout(() => done(false), ${seconds * 1000});
  })`);
  if (!come) throw new Error(`never: ${script}`);
}

/** A profile with its tables. */
function withTables(profile) {
  const tables = [...readFileSync(profile, "utf8").matchAll(/"([^"]+\.csv)"/g)].map(([, table]) =>
    join(dirname(profile), table),
  );
  return [profile, ...tables].map((path) => resolve(path));
}

/** Runs a correction in the page. */
async function inPage(browser, program) {
  const files = [resolve(program), ...withTables(given.machine)];
  await browser.evaluate("(files.clear(), made.clear(), typed.clear(), job = JOBS[0], show(), 0)");
  await browser.into("#picked", files);
  await wait(browser, `files.size === ${files.length}`);
  await browser.evaluate(
    `(typed.set("dialect", ${JSON.stringify(given.dialect)}), show(), by("status").textContent = "", window.begun = performance.now(), by("run").click(), 0)`,
  );
  await wait(browser, 'by("cancel").hidden && by("status").textContent', 300);
  return browser.evaluate(`(async () => {
    const hash = async (blob) => [...new Uint8Array(await crypto.subtle.digest("SHA-256", await blob.arrayBuffer()))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
    const all = {};
    for (const name of made.keys()) if (/_(corrected|summary)\\.[^.]*$/.test(name)) all[name] = await hash(files.get(name));
    return { isDone: by("status").className === "good", all, ms: performance.now() - window.begun };
  })()`);
}

/** The same by the command, in a folder of its own. */
function byCommand(program) {
  const folder = mkdtempSync(join(tmpdir(), "vpost-page-"));
  for (const path of withTables(given.machine)) {
    const to = join(folder, path.slice(resolve(dirname(given.machine)).length + 1));
    mkdirSync(dirname(to), { recursive: true });
    copyFileSync(path, to);
  }
  const name = basename(program);
  copyFileSync(program, join(folder, name));
  const dot = name.lastIndexOf(".");
  const [stem, ending] = dot > 0 ? [name.slice(0, dot), name.slice(dot)] : [name, ""];
  const made = [`${stem}_corrected${ending}`, `${stem}_summary.json`];
  const ran = spawnSync(
    resolve(given.vpost),
    [
      "correct",
      name,
      `--machine=${basename(given.machine)}`,
      `--dialect=${given.dialect}`,
      `--output=${made[0]}`,
      `--summary=${made[1]}`,
    ],
    { cwd: folder, env: { ...process.env, LC_ALL: "C" }, timeout: PATIENCE },
  );
  const all = {};
  if (ran.status === 0) {
    for (const file of made) all[file] = execFileSync("sha256sum", [file], { cwd: folder }).toString().slice(0, 64);
  }
  rmSync(folder, { recursive: true });
  return { isDone: ran.status === 0, all };
}

let wrong = 0;
const expected = new Map([...programs, ...given.speed].map((program) => [program, byCommand(program)]));
for (const name of given.browser) {
  const folder = mkdtempSync(join(tmpdir(), "vpost-browser-"));
  const browser = await browsers[name](resolve(given.page), folder);
  try {
    await wait(browser, "described.size > 0");
    await browser.evaluate(`(window.tasks = [], PerformanceObserver.supportedEntryTypes.includes("longtask")
      && new PerformanceObserver((list) => tasks.push(...list.getEntries().map((task) => task.duration))).observe({ entryTypes: ["longtask"] }), 0)`);
    let [same, done] = [0, 0];
    for (const [program, { isDone, all }] of expected) {
      const found = await inPage(browser, program);
      const isSame = found.isDone === isDone && JSON.stringify(found.all) === JSON.stringify(all);
      if (isSame) same++;
      else
        console.log(
          `${name}: ${program}: ${JSON.stringify(found)} where the command has ${JSON.stringify({ isDone, all })}`,
        );
      done += isDone;
      if (given.speed.includes(program)) console.log(`${name}: ${program}: ${(found.ms / 1000).toFixed(1)} s`);
    }
    const longest = Math.max(0, ...(await browser.evaluate("tasks")));
    const told = browser.told();
    console.log(
      `${name}: ${same} of ${expected.size} the same, ${done} of them corrected, ${expected.size - done} refused alike; longest task ${longest} ms; ${told.length} requests and console messages`,
    );
    if (told.length) console.log(JSON.stringify(told).slice(0, 2000));
    wrong += expected.size - same + told.length + (longest > LONGEST_MS);
  } finally {
    browser.end();
  }
}
process.exit(wrong ? 1 : 0);
