// Chromium and Firefox for judges of pages: each opens a page from the disk in a profile folder, and is driven by its own
// protocol over a WebSocket, DevTools or BiDi. Nothing here judges.

import { spawn } from "node:child_process";

/** Starts a browser and speaks with it over the WebSocket that it names: questions by number, what comes unasked. */
async function started(command, words, listens, path = "") {
  const child = spawn(command, words, { stdio: ["ignore", "ignore", "pipe"] });
  const address = await new Promise((done, failed) => {
    let said = "";
    child.stderr.on("data", (bytes) => {
      said += bytes;
      const found = listens.exec(said);
      if (found) done(found[1] + path);
    });
    child.on("error", failed).on("exit", () => failed(new Error(said)));
  });
  const line = new WebSocket(address);
  await new Promise((done, failed) => Object.assign(line, { onopen: done, onerror: failed }));
  const waiting = new Map();
  const unasked = [];
  let last = 0;
  line.onmessage = ({ data }) => {
    const told = JSON.parse(data);
    const [done, failed] = waiting.get(told.id) ?? [() => unasked.push(told)];
    waiting.delete(told.id);
    if (told.error) failed(new Error(JSON.stringify(told)));
    else done(told.result);
  };
  const ask = (method, params = {}, more = {}) =>
    new Promise((...answer) => {
      waiting.set(++last, answer);
      line.send(JSON.stringify({ id: last, method, params, ...more }));
    });
  return { child, ask, unasked };
}

/** Of what came unasked: requests that leave the computer, messages of the console. */
const told = (unasked) =>
  unasked.filter(({ method, params }) =>
    /request/i.test(method)
      ? !/^(file|blob|data|about):/.test(params.request?.url ?? "file:")
      : /consoleAPICalled|exceptionThrown|entryAdded/.test(method),
  );

async function chromium(page, folder) {
  const words = ["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000", "--remote-debugging-port=0"];
  words.push(`--user-data-dir=${folder}`, "about:blank");
  const { child, ask, unasked } = await started("chromium", words, /DevTools listening on (ws:\S+)/);
  const { targetId } = await ask("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await ask("Target.attachToTarget", { targetId, flatten: true });
  const tell = (method, params) => ask(method, params, { sessionId });
  for (const part of ["Page", "Runtime", "Log", "Network"]) await tell(`${part}.enable`);
  await tell("Page.navigate", { url: `file://${page}` });
  const evaluate = async (expression) => {
    const how = { expression, awaitPromise: true, returnByValue: true };
    const { result, exceptionDetails } = await tell("Runtime.evaluate", how);
    if (exceptionDetails) throw new Error(JSON.stringify(exceptionDetails));
    return result.value;
  };
  const into = async (selector, files) => {
    const { root } = await tell("DOM.getDocument");
    const { nodeId } = await tell("DOM.querySelector", { nodeId: root.nodeId, selector });
    await tell("DOM.setFileInputFiles", { files, nodeId });
  };
  /** A drag of files and folders from the disk, as the system hands it over. */
  const drag = async (files) => {
    const [x, y] = await evaluate(`(() => { const place = document.getElementById("drop"); place.scrollIntoView();
      const box = place.getBoundingClientRect(); return [box.x + 20, box.y + 20]; })()`);
    const data = { items: [], files, dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) await tell("Input.dispatchDragEvent", { type, x, y, data });
  };
  return { end: () => child.kill(), told: () => told(unasked), evaluate, into, drag };
}

async function firefox(page, folder) {
  const words = ["--headless", "--remote-debugging-port", "0", "--profile", folder, "--no-remote", "about:blank"];
  const listens = /WebDriver BiDi listening on (ws:\S+)/;
  const { child, ask, unasked } = await started("firefox-esr", words, listens, "/session");
  await ask("session.new", { capabilities: {} });
  const { context } = (await ask("browsingContext.getTree")).contexts[0];
  await ask("session.subscribe", { events: ["log.entryAdded", "network.beforeRequestSent"] });
  await ask("browsingContext.navigate", { context, url: `file://${page}`, wait: "complete" });
  const evaluate = async (script) => {
    const expression = `(async () => JSON.stringify(await (${script})))()`;
    const answer = await ask("script.evaluate", { expression, target: { context }, awaitPromise: true });
    if (answer.type === "exception") throw new Error(JSON.stringify(answer.exceptionDetails));
    return answer.result.value === undefined ? undefined : JSON.parse(answer.result.value);
  };
  const into = async (selector, files) => {
    const { nodes } = await ask("browsingContext.locateNodes", { context, locator: { type: "css", value: selector } });
    await ask("input.setFiles", { context, element: { sharedId: nodes[0].sharedId }, files });
  };
  return { end: () => child.kill(), told: () => told(unasked), evaluate, into };
}

/** By name: what opens (page, profile folder) and returns evaluate, into (an input by selector, files), told, end. */
export const browsers = { chromium, firefox };
