% The .m, the CSV and the family in Octave, by interp1 and interp2, against rows that no table holds.
function ok = check(name, force, truth)
  off = max(abs(force ./ truth - 1));
  printf("%s: within %.3g %% at %d unseen indentations\n", name, 100 * off, numel(truth));
  ok = numel(truth) == 500 && off < 1e-3;
end

header = strsplit(strtrim(fgetl(fopen("truth/table.csv"))), ",");
x_column = find(strcmp(header, "indentation_mm"));
cells = textscan(fopen("truth/table.csv"), repmat("%s", 1, numel(header)), "Delimiter", ",", "HeaderLines", 1);
x = cellfun(@str2double, cells{x_column});
truth = cellfun(@str2double, cells{find(strcmp(header, "force_n"))});
slope = cellfun(@str2double, cells{find(strcmp(header, "tangent_stiffness_n_per_mm"))});

joint_table;
ok = check(".m", interp1(joint_indentation', joint_force, 1e-3 * x), truth);
ok = ok && max(abs(interp1(joint_indentation', joint_stiffness, 1e-3 * x) ./ (1e3 * slope) - 1)) < 5e-3;
table = dlmread("joint_table.csv", ",", 1, 0);
ok = check("CSV", interp1(table(:, 1), table(:, 2), x), truth) && ok;
family;
ok = ok && isequal(size(family_force), [numel(family_indentation), numel(family_radial_clearance)]);
between = interp2(family_radial_clearance, family_indentation', family_force, 0.02e-3, 1e-3 * x);
off = max(abs(between ./ truth - 1));
printf("family: within %.3g %% between its clearances\n", 100 * off);
ok = ok && off < 0.02;
if ! ok
  exit(1);
end
