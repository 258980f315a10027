function refused(folder)
% Files that mascot.read_npz refuses, by their words.
in = @(name) fullfile(folder, name);
expect_error(@() mascot.read_npz(in('missing.npz')), 'mascot:file', ['cannot open ' in('missing.npz')]);
expect_error(@() mascot.read_npz(in('packed.npz')), 'mascot:file', ...
             [in('packed.npz') ': expected arrays that are not compressed']);
expect_error(@() mascot.read_npz(in('text.npz')), 'mascot:file', [in('text.npz') ': expected a file of NumPy arrays']);
expect_error(@() mascot.read_npz(in('cut.npz')), 'mascot:file', [in('cut.npz') ': a.npy is cut short']);
expect_error(@() mascot.read_npz(in('words.npz')), 'mascot:file', ...
             [in('words.npz') ': a.npy: expected an array of numbers in the order of C, got .*']);
expect_error(@() mascot.read_npz(in('other.npz')), 'mascot:file', [in('other.npz') ': a.txt is no NumPy array']);
end
