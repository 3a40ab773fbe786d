// Reads a recording with @mcap/core and @mcap/support and prints what it found as one JSON object:
// node read_mcap.mjs WEB_FOLDER RECORDING. WEB_FOLDER holds node_modules.
import { createHash } from "node:crypto";
import { open } from "node:fs/promises";
import { createRequire } from "node:module";
import path from "node:path";

const [webFolder, recording] = process.argv.slice(2);
const require = createRequire(path.join(path.resolve(webFolder), "package.json"));
const { McapIndexedReader } = require("@mcap/core");
const { loadDecompressHandlers, protobufFromBinaryDescriptor } = require("@mcap/support");

const file = await open(recording);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const bytes = new Uint8Array(Number(size));
    const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
    return bytes.subarray(0, bytesRead);
  },
};
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: await loadDecompressHandlers(),
});

function parserOf(channel, schema) {
  if (channel.messageEncoding === "json") return (data) => JSON.parse(new TextDecoder().decode(data));
  const type = protobufFromBinaryDescriptor(schema.data).lookupType(schema.name);
  return (data) => type.decode(data);
}

const topics = {};
const parsers = new Map();
let lastTime = 0n;
let ordered = true;
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!parsers.has(channel.id)) parsers.set(channel.id, parserOf(channel, schema));
  const topic = (topics[channel.topic] ??= {
    schema: schema.name, encoding: channel.messageEncoding, times: [], digests: [], encodings: [],
  });
  const value = parsers.get(channel.id)(message.data);
  const bytes = value.data instanceof Uint8Array ? value.data : message.data;
  topic.times.push(String(message.logTime));
  topic.digests.push(createHash("sha256").update(bytes).digest("hex"));
  if (typeof value.encoding === "string") topic.encodings.push(value.encoding);
  ordered = ordered && message.logTime >= lastTime;
  lastTime = message.logTime;
}
const metadata = {};
for await (const record of reader.readMetadata()) metadata[record.name] = Object.fromEntries(record.metadata);
await file.close();
console.log(JSON.stringify({ topics, metadata, ordered, messages: Number(reader.statistics.messageCount) }));
