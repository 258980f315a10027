// answers.mjs FOLDER: for each NAME.onnx in FOLDER, writes what ONNX Runtime answers to the row of numbers in NAME.json
// to NAME.answer.json.
import * as ort from "onnxruntime-web";
import fs from "node:fs";

const folder = process.argv[2];
ort.env.wasm.numThreads = 1;
ort.env.logLevel = "error";
for (const file of fs.readdirSync(folder).filter((name) => name.endsWith(".onnx"))) {
  const name = `${folder}/${file.slice(0, -".onnx".length)}`;
  const row = JSON.parse(fs.readFileSync(`${name}.json`));
  const session = await ort.InferenceSession.create(fs.readFileSync(`${folder}/${file}`), {executionProviders: ["wasm"]});
  const answer = await session.run({x: new ort.Tensor("float32", Float32Array.from(row), [1, row.length])});
  fs.writeFileSync(`${name}.answer.json`, JSON.stringify([...answer.y.data]));
  await session.release();
}
