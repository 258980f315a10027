// Debian's headless Chromium, and what every test of the page wants of a window.
import {existsSync} from "node:fs";
import {chromium} from "playwright-core";

const PROGRAMS = ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium"];
// Without a graphics card; as root, as in a container.
const OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const QUICK = ["--webgl-antialiasing-mode=none"];
export const WIDE = {
  width: 1280,
  height: 800
},
             SMALL = {
               width: 960,
               height: 600
             },
             PHONE = {
               width: 390,
               height: 844
             };

/** `fine`: smooth lines, for pictures. */
export function launch({fine = false} = {}) {
  const executablePath = PROGRAMS.find((program) => existsSync(program));
  if (!executablePath) throw new Error(`none of ${PROGRAMS.join(", ")} is installed: scripts/setup --test installs it`);
  return chromium.launch({executablePath, args: fine ? OPTIONS : [...OPTIONS, ...QUICK]});
}

/** A window on a page. `troubles` has what no page may do: errors, warnings, requests that leave its host. */
export async function open(browser, url, {size = SMALL, colorScheme = "light", ...options} = {}) {
  const context = await browser.newContext(
      {viewport: size, colorScheme, reducedMotion: "reduce", hasTouch: size === PHONE, ...options});
  const page = await context.newPage(), troubles = [], host = new URL(url).host;
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && troubles.push(message.text()));
  page.on("pageerror", (error) => troubles.push(String(error)));
  page.on(
      "request",
      (request) => !request.url().startsWith("data:") && new URL(request.url()).host !== host &&
          troubles.push(`request to ${request.url()}`));
  page.on(
      "response",
      (response) => response.status() >= 400 && troubles.push(`${response.status()} for ${response.url()}`));
  await page.goto(url);
  await page.waitForFunction(() => window.mascot?.tick >= 0, undefined, {timeout: 60_000});
  return {page, troubles, close: () => context.close()};
}
