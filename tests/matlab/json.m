function json(numbers, answers)
% Reads and writes numbers, of which FILE has one in each line, and texts.
values = mascot.decode_json(fileread(numbers));
file = fopen(answers, 'w');
fprintf(file, '%s\n', mascot.json_text({values.list, values.nested, values.text, true, {}, {1}, [1 2; 3 4], ...
                                         int32(7), struct('a', {1, 2}), containers.Map({'law.p_gain'}, {0.1})}));
fclose(file);
assert(isequaln(values.holes(:).', [1 NaN 3]));
expect_error(@() mascot.json_text(@sin), 'mascot:json', 'JSON has no value like this function_handle');
end
