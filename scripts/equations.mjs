// Sets equations in type, by Debian's KaTeX: reads a JSON list of {tex, display} from standard input, and prints the list
// of their HTML. A macro that KaTeX does not know ends it with exit code 1 and a message.
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";

const katex = createRequire(import.meta.url)("/usr/share/javascript/katex/katex.min.js");

function typeset({tex, display}) {
  try {
    return katex.renderToString(tex, {displayMode: display, fleqn: true, strict: "error"});
  } catch (error) {
    console.error(`${error.message}, in ${tex}`);
    process.exit(1);
  }
}

console.log(JSON.stringify(JSON.parse(readFileSync(0, "utf8")).map(typeset)));
