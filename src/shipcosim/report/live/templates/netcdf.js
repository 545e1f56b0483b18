// A table as a file of NetCDF 3 with 64-bit offsets, which the netCDF libraries, xarray, MATLAB and Julia read.
// The format: docs.unidata.ucar.edu/netcdf-c/current/file_format_specifications.html

// Columns: { name, kind, unit, text, values }, the first of them the times; attributes: texts and numbers of the whole table.
function netcdfOf(attributes, columns) {
  const DIMENSION = 10, VARIABLE = 11, ATTRIBUTE = 12, CHAR = 2, DOUBLE = 6;
  const TYPES = { Boolean: [1, 1, "setInt8"], Integer: [4, 4, "setInt32"], Real: [6, 8, "setFloat64"] };  // code, bytes, and how it is written
  const PLAIN = /^[A-Za-z0-9_][\w.+@()[\] -]*$/, padded = (size) => 4 * Math.ceil(size / 4);

  // All numbers have their most significant byte first, which is what a DataView writes.
  function numbers(type, values) {
    const [, size, write] = TYPES[type], bytes = new Uint8Array(padded(size * values.length)), view = new DataView(bytes.buffer);
    for (let k = 0; k < values.length; k++) view[write](k * size, values[k]);
    return bytes;
  }

  const int = (value) => numbers("Integer", [value]), offset = (value) => [int(Math.floor(value / 2 ** 32)), int(value % 2 ** 32 | 0)];
  function string(value) {
    const bytes = new TextEncoder().encode(value), filled = new Uint8Array(padded(bytes.length));
    filled.set(bytes);
    return [int(bytes.length), filled];
  }
  const list = (tag, entries) => (entries.length ? [int(tag), int(entries.length), ...entries] : [int(0), int(0)]);
  const attribute = ([name, value]) => [string(name), typeof value === "number" ? [int(DOUBLE), int(1), numbers("Real", [value])] : [int(CHAR), string(value)]];

  // Names that NetCDF does not have stand in an attribute, and truth values are marked, both as in our other files.
  function attributesOf({ name, kind, unit, text }) {
    const found = { units: unit, long_name: text };
    if (kind === "Boolean") found.dtype = "bool";
    if (!PLAIN.test(name)) found.own_name = name;
    return Object.entries(found);
  }

  const parts = columns.map(({ kind, values }) => numbers(kind, values)), rows = columns[0].values.length;
  function header(first) {  // with the place of the first column's numbers
    let begin = first;
    const variables = columns.map((column, k) => {
      const name = PLAIN.test(column.name) ? column.name : `_${encodeURIComponent(column.name)}`;
      const entry = [string(name), int(1), int(0), list(ATTRIBUTE, attributesOf(column).map(attribute)), int(TYPES[column.kind][0]), int(parts[k].length), offset(begin)];
      begin += parts[k].length;
      return entry;
    });
    const dimension = [string(columns[0].name), int(rows)];
    return [new Uint8Array([67, 68, 70, 2]), int(0), list(DIMENSION, [dimension]), list(ATTRIBUTE, Object.entries(attributes).map(attribute)), list(VARIABLE, variables)].flat(Infinity);
  }

  const length = header(0).reduce((sum, { length }) => sum + length, 0);
  return new Blob([...header(length), ...parts], { type: "application/x-netcdf" });
}
