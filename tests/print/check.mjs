// Looks at the worksheet's pages in a headless browser: `node check.mjs FOLDER BROWSER`, where FOLDER holds
// what `worksheet --edition both --json` has written, its output as rows.json. Says all that is wrong; PDFs
// stay in the folder.

import { readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import path from "node:path";
import puppeteer from "puppeteer-core";

const [folder, executablePath] = process.argv.slice(2);
const axe = createRequire(import.meta.url).resolve("axe-core/axe.min.js");

const PAPERS = { A4: [794, 1123], Letter: [816, 1056] }; // in CSS pixels
const MOST_PAPER = { student: 5, solution: 8, extremes: null, trade: null };
const SCREENS = [1200, 360];

const faults = [];
const browser = await puppeteer.launch({ executablePath, args: ["--no-sandbox"] });

for (const [name, most] of Object.entries(MOST_PAPER)) {
  const page = await browser.newPage();
  await page.goto(`file://${path.resolve(folder, `${name}.html`)}`);
  for (const [paper, [width, height]] of Object.entries(PAPERS)) {
    // as browsers print by themselves: no backgrounds
    const pdf = await page.pdf({ format: paper, printBackground: false });
    await writeFile(path.join(folder, `${name}-${paper}.pdf`), pdf);
    const sheets = Buffer.from(pdf).toString("latin1").match(/\/Type\s*\/Page\b/g).length;
    console.log(`${name}.html on ${paper}: ${sheets} pages`);
    if (most && sheets > most) {
      faults.push(`${name}.html takes ${sheets} pages of ${paper}, more than ${most}`);
    }
    if (most) {
      await page.emulateMediaType("print");
      // what is left between the margins of 15 mm
      await page.setViewport({ width: Math.floor(width - 30 * 96 / 25.4), height });
      await look(page, `${name}.html on ${paper}`);
      if (name === "student") await tells_nothing(await page.evaluate(said), `the sheet on ${paper}`);
      await page.emulateMediaType(null);
    }
  }
  for (const width of SCREENS) {
    await page.setViewport({ width, height: 800 });
    await look(page, `${name}.html at ${width} px`);
    await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = true)));
    await look(page, `${name}.html at ${width} px, unfolded`);
    if (name === "student") await tells_nothing(await page.evaluate(said), `the sheet at ${width} px`);
    await page.addScriptTag({ path: axe });
    const { violations } = await page.evaluate(() => window.axe.run());
    for (const { id, impact, nodes } of violations) {
      const where = `${name}.html at ${width} px`;
      const what = `${where}: axe finds ${id} (${impact}) ${nodes.length} times, as in ${nodes[0].html}`;
      if (["serious", "critical"].includes(impact)) faults.push(what);
      else console.log(what);
    }
    await page.evaluate(() => document.querySelectorAll("details").forEach((one) => (one.open = false)));
  }
  await page.close();
}
await browser.close();

for (const fault of faults) console.error(fault);
console.log(faults.length ? `${faults.length} faults` : "the pages are sound");
process.exit(faults.length ? 1 : 0);

/** Whatever sticks out of its box or of the page, scrolls, or has an id that is no name. */
async function look(page, where) {
  const found = await page.evaluate(() => {
    const found = [];
    const say = (element, what) => found.push(`${what}: ${element.outerHTML.slice(0, 110)}`);
    const root = document.documentElement;
    if (root.scrollWidth > innerWidth) found.push(`the page is ${root.scrollWidth - innerWidth} px too wide`);
    for (const element of document.body.querySelectorAll("*")) {
      if (element.id && !/^[A-Za-z][\w-]*$/.test(element.id)) say(element, "no name");
      if (element.closest("svg, thead") && element.localName !== "svg") continue;
      if (!element.checkVisibility()) continue;
      const { left, right, top, bottom, width } = element.getBoundingClientRect();
      if (!width) continue;
      if (left < -0.5 || right > innerWidth + 0.5) say(element, "off the page");
      const { overflowX, overflowY } = getComputedStyle(element);
      const scrolls = (value) => ["auto", "scroll"].includes(value);
      if (element.localName !== "svg" && (scrolls(overflowX) || scrolls(overflowY))) say(element, "scrolls");
      const inline = getComputedStyle(element).display === "inline" || element.closest("math");
      const box = !inline && element.localName !== "svg";
      const wider = element.scrollWidth - element.clientWidth;
      const taller = element.scrollHeight - element.clientHeight;
      if (box && wider > 1) say(element, `${wider} px too wide`);
      // a subscript may hang below the last line
      if (box && taller > 6) say(element, `${taller} px too tall`);
      if (["math", "svg"].includes(element.localName)) {
        const outer = element.closest(".formula, figure, article").getBoundingClientRect();
        if (left < outer.left - 1 || right > outer.right + 1) say(element, "wider than its box");
        if (top < outer.top - 3 || bottom > outer.bottom + 3) say(element, "taller than its box");
      }
    }
    return found;
  });
  faults.push(...found.map((what) => `${where}: ${what}`));
}

/** All that a reader sees or hears of the page at hand. */
function said() {
  const figures = [...document.querySelectorAll("svg")].map((svg) => svg.textContent);
  return document.body.innerText + figures.join(" ");
}

/** Neither the key's sentences nor the values of closed forms, where these have digits enough. */
async function tells_nothing(text, where) {
  const letters = (text) => text.replace(/[^\p{L}\p{N}]/gu, "");
  const lines = (await readFile(path.join(folder, "rows.json"), "utf8")).trim().split("\n");
  const rows = lines.map((row) => JSON.parse(row));
  const truths = rows.map((row) => row.truth).filter((truth) => truth !== null);
  const values = truths.filter((truth) => Math.abs(truth * 1000 - Math.trunc(truth * 1000)) > 1e-9);
  const key = await browser.newPage();
  await key.goto(`file://${path.resolve(folder, "solution.html")}`);
  const secrets = await key.evaluate(() =>
    [...document.querySelectorAll(".why, .original, .formula, dd")].map((element) => element.textContent));
  await key.close();
  if (secrets.length < 50 || values.length < 10) {
    faults.push(`${secrets.length} sentences and ${values.length} values are too few`);
  }
  for (const secret of new Set(secrets)) {
    const inside = letters(secret);
    if (inside.length > 7 && letters(text).includes(inside)) faults.push(`${where} says "${secret}"`);
  }
  for (const value of new Set(values.map((value) => value.toFixed(3)))) {
    if (text.includes(value)) faults.push(`${where} says ${value}`);
  }
}
