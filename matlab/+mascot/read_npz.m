function arrays = read_npz(file)
% read_npz(FILE) reads a file of NumPy arrays (states.npz) into a struct, with a field for each array, of its shape:
% a(k, i, axis) is NumPy's a[k-1, i-1, axis-1]. It reads what MASCOT writes: arrays of numbers that are not
% compressed. Error mascot:file: what is wrong with the file.
id = fopen(file, 'r', 'ieee-le');
if id < 0, error('mascot:file', 'cannot open %s', file); end
cleanup = onCleanup(@() fclose(id));
arrays = struct();
% A zip file is local headers, each with its array behind it, and then a directory, which this function does not need.
while true
  signature = fread(id, 1, 'uint32');
  if ~isequal(signature, hex2dec('04034b50')), break, end
  head = fread(id, 2, 'uint16');  % version, flags
  method = fread(id, 1, 'uint16');
  fseek(id, 8, 'cof');  % time, date, checksum
  packed = fread(id, 1, 'uint32');
  fseek(id, 4, 'cof');
  lengths = fread(id, 2, 'uint16');  % of the name and of the extra field
  name = fread(id, lengths(1), 'uint8=>char').';
  extra = fread(id, lengths(2), 'uint8=>uint8').';
  if packed == intmax('uint32'), packed = size_in(extra); end
  start = ftell(id);
  if numel(head) < 2 || isempty(method) || method ~= 0 || bitand(head(2), 8) ~= 0
    error('mascot:file', '%s: expected arrays that are not compressed', file);
  end
  arrays.(regexprep(name, '\.npy$', '')) = array_at(id, file, name);
  if fseek(id, start + packed, 'bof') ~= 0, error('mascot:file', '%s: %s is cut short', file, name); end
end
if isempty(fieldnames(arrays)), error('mascot:file', '%s: expected a file of NumPy arrays', file); end
end

function bytes = size_in(extra)
% The size in the extra field of files of 4 GiB and more (ZIP64).
at = 1;
while at + 3 <= numel(extra)
  words = double(typecast(extra(at:at + 3), 'uint16'));
  if words(1) == 1, bytes = double(typecast(extra(at + 12:at + 19), 'uint64')); return, end
  at = at + 4 + words(2);
end
error('mascot:file', 'a size is missing');
end

function array = array_at(id, file, name)
start = fread(id, 8, 'uint8=>uint8').';
if ~isequal(start(1:min(end, 6)), uint8([147, double('NUMPY')]))
  error('mascot:file', '%s: %s is no NumPy array', file, name);
end
if start(7) == 1, length = fread(id, 1, 'uint16'); else, length = fread(id, 1, 'uint32'); end
head = fread(id, length, 'uint8=>char').';
types = struct('f8', 'double', 'f4', 'single', 'i8', 'int64', 'i4', 'int32', 'u8', 'uint64', 'u4', 'uint32', ...
               'u2', 'uint16', 'u1', 'uint8', 'i2', 'int16', 'i1', 'int8');
type = regexp(head, '''descr'': ''[<|](\w\d)''', 'tokens', 'once');
shape = regexp(head, '''shape'': \(([^)]*)\)', 'tokens', 'once');
if isempty(type) || ~isfield(types, type{1}) || isempty(shape) || isempty(strfind(head, '''fortran_order'': False'))
  error('mascot:file', '%s: %s: expected an array of numbers in the order of C, got %s', file, name, strtrim(head));
end
shape = sscanf(strrep(shape{1}, ',', ' '), '%d').';
[array, count] = fread(id, prod(shape), [types.(type{1}) '=>' types.(type{1})]);
if count < prod(shape), error('mascot:file', '%s: %s is cut short', file, name); end
if numel(shape) > 1, array = permute(reshape(array, fliplr(shape)), numel(shape):-1:1); end
end
