"""Reads the tables of cloth_study --parts reality, and writes tables for docs/reality.md."""
import math

from tables import markdown_table, read, significant

# Drape coefficients that were published, in per cent. Broadcloth and faille: Matsudaira et al. 2015.
MEASURED_DRAPE = {'broadcloth': 82.9, 'faille': 28.3}
FARTHEST = 0.10  # relative difference from which on a value counts as a misfit


def at_least_energy(rows):
    """Of each fabric on each mesh, the drape of least energy among its starts."""
    best = {}
    for row in rows:
        key = tuple(row[name] for name in ('fabric', 'shows', 'bending', 'density', 'shear', 'side',
                                           'turn'))
        if key not in best or float(row['energy']) < float(best[key]['energy']):
            best[key] = row
    return list(best.values())


def over_density(drapes, fabric, shows):
    """Drapes of a fabric by density, ascending, without friction ('density') or with it
    ('hysteresis'); the chosen density is among those of the meshes."""
    rows = [row for row in drapes if (row['fabric'], row['shows']) == (fabric, shows)]
    if shows == 'density' and rows:
        rows += [row for row in drapes if (row['fabric'], row['shows']) == (fabric, 'mesh') and
                 row['side'] == rows[0]['side'] and float(row['turn']) == 0.0]
    return sorted(rows, key=lambda row: float(row['density']))


def misfit(text, simulated, measured, most=FARTHEST):
    """The text, in bold if the simulated value is off by more than `most` of the measured one."""
    good = math.isfinite(simulated) and abs(simulated / measured - 1.0) <= most
    return text if good else f'**{text}**'


def per_cent_off(simulated, measured):
    return f'{100.0 * (simulated / measured - 1.0):+.1f} %'.replace('-', '−')


class Reality:
    """The functions that the template may call, over the tables of a folder."""

    def __init__(self, folder):
        for name in ('cantilever', 'fold', 'drape', 'fling', 'pull', 'slope', 'swing', 'tear', 'notch'):
            setattr(self, name, read(folder, f'reality_{name}.csv'))
        self.drapes = at_least_energy(self.drape)

    # ---- bending

    def cantilever_table(self):
        rows = []
        for row in sorted(self.cantilever, key=lambda row: float(row['bending_over_density'])):
            standard, simulated = float(row['standard_overhang']), float(row['simulated_overhang'])
            source = f"`{row['source']}`" if row['source'].startswith('src') else row['source']
            rows.append([row['fabric'], source, f"{1e6 * float(row['bending']):.3g}", row['density'],
                         f'{1e3 * standard:.2f}', f'{1e3 * simulated:.2f}',
                         misfit(per_cent_off(simulated, standard), simulated, standard, 0.02)])
        return markdown_table(['fabric', 'B and ρ from', 'B [µN m]', 'ρ [kg/m²]',
                               'ASTM D1388 [mm]', 'simulated [mm]', 'difference'], rows)

    def worst_cantilever(self):
        return max(abs(float(row['simulated_over_standard']) - 1.0) for row in self.cantilever)

    def range_of(self, rows):
        values = [float(row['bending_over_density']) for row in rows]
        return max(values) / min(values)

    def fold_table(self):
        rows = []
        for row in sorted(self.fold, key=lambda row: float(row['bending_over_density'])):
            ratio, elastica = float(row['height_over_length']), float(row['elastica'])
            rows.append([row['fabric'], f"{1e3 * float(row['length']):.1f}",
                         f'{1e3 * elastica * float(row["length"]):.2f}',
                         f"{1e3 * float(row['height']):.2f}", f'{ratio:.3f}',
                         misfit(per_cent_off(ratio, elastica), ratio, elastica, 0.03)])
        return markdown_table(['fabric', 'l [mm]', 'elastica [mm]', 'simulated [mm]', 'over l',
                               'difference'], rows)

    def fold_ratios(self):
        return [float(row['height_over_length']) for row in self.fold]

    # ---- drape

    def of_drapes(self, fabric, shows):
        return [row for row in self.drapes if (row['fabric'], row['shows']) == (fabric, shows)]

    def coefficients(self, fabric, shows):
        return [float(row['coefficient']) for row in self.of_drapes(fabric, shows)]

    def usual_drape(self, fabric):
        """On the finest mesh."""
        return min(self.of_drapes(fabric, 'mesh'), key=lambda row: float(row['side']))

    def drape_table(self, shows):
        """What was varied, beside what was measured."""
        rows = []
        for fabric, measured in MEASURED_DRAPE.items():
            for row in self.of_drapes(fabric, shows):
                value = float(row['coefficient'])
                rows.append([fabric, f"{1e6 * float(row['bending']):.4g}", row['density'],
                             row['shear'], f"{1e3 * float(row['side']):g}", row['turn'],
                             f'{measured:.1f}', misfit(f'{value:.1f}', value, measured),
                             row['folds'], self.starts_of(row)])
        return markdown_table(['fabric', 'B [µN m]', 'ρ [kg/m²]', 'G [N/m]', 'triangles [mm]',
                               'turn', 'measured [%]', 'simulated [%]', 'folds', 'all starts [%]'],
                              rows)

    def starts_of(self, row):
        """Range of the drapes from all starts."""
        starts = [float(other['coefficient']) for other in self.drape
                  if all(other[name] == row[name] for name in
                         ('fabric', 'shows', 'bending', 'density', 'shear', 'side', 'turn'))]
        return f'{min(starts):.1f} to {max(starts):.1f}'

    def over_density(self, fabric, shows):
        return over_density(self.drapes, fabric, shows)

    def density_table(self):
        """The drape over the density, without and with the friction of the yarns."""
        rows = []
        for fabric, measured in MEASURED_DRAPE.items():
            for pair in zip(self.over_density(fabric, 'density'),
                            self.over_density(fabric, 'hysteresis')):
                cells = []
                for row in pair:
                    value = float(row['coefficient'])
                    cells += [misfit(f'{value:.1f}', value, measured), row['folds'],
                              self.starts_of(row)]
                rows.append([fabric, pair[0]['density'], f'{measured:.1f}'] + cells)
        return markdown_table(['fabric', 'ρ [kg/m²]', 'measured [%]', 'simulated [%]', 'folds',
                               'all starts [%]', 'with friction [%]', 'folds', 'all starts [%]'],
                              rows)

    def drape_at(self, fabric, shows, density):
        [row] = [row for row in self.over_density(fabric, shows) if float(row['density']) == density]
        return float(row['coefficient'])

    def density_of(self, fabric, shows):
        """The density at which the fabric drapes as measured, between two of the table [kg/m^2];
        NaN if there is none."""
        points = [(float(row['density']), float(row['coefficient']))
                  for row in self.over_density(fabric, shows)]
        measured = MEASURED_DRAPE[fabric]
        for (light, above), (heavy, below) in zip(points, points[1:]):
            if below <= measured <= above:
                return light + (heavy - light) * (above - measured) / (above - below)
        return math.nan

    # ---- fling

    def fling_table(self):
        rows = []
        for row in self.fling:
            setting = (f"`error: {float(row['error']):g}`" if float(row['error']) > 0.0 else
                       row['substeps'] if int(row['substeps']) else 'half of the stable step')
            rows.append([f"`{row['method']}`", setting, f"{row['columns']} x {row['rows']}"] +
                        [f'{1e3 * float(row[name]):.1f}' for name in
                         ('distance', 'chamfer_to_reference', 'chamfer_from_reference')])
        return markdown_table(['method', 'substeps', 'particles', 'rms distance [mm]',
                               'Chamfer, to the reference [mm]', 'from it [mm]'], rows)

    def farthest_fling(self, columns=None):
        return max(float(row['distance']) for row in self.fling
                   if columns is None or int(row['columns']) == columns)

    # ---- pull

    def pull_table(self):
        rows = []
        for row in self.pull:
            fitted, simulated = float(row['fitted']), float(row['simulated'])
            text = (f'{significant(simulated, 3)}' if math.isfinite(simulated)
                    else 'did not come to rest')
            rows.append([row['preset'], row['pull'], row['strain'], significant(fitted, 3),
                         misfit(text, simulated, fitted)])
        return markdown_table(['preset', 'pull', 'strain', 'fit to measurements [N/m]',
                               'simulated [N/m]'], rows)

    def pull_ratio(self, preset, pull, strain):
        """Simulated force over that of the fit."""
        [row] = [row for row in self.pull if (row['preset'], row['pull'], float(row['strain'])) ==
                 (preset, pull, strain)]
        return float(row['simulated']) / float(row['fitted'])

    # ---- slope and swing

    def slope_table(self):
        return markdown_table(
            ['slope [degrees]', 'expected', 'slide in 0.25 s [mm]'],
            [[row['slope'], 'holds' if float(row['slope']) < float(row['angle_of_friction'])
              else 'slides', f"{1e3 * float(row['slide']):.2f}"] for row in self.slope])

    def slides(self, above):
        return [float(row['slide']) for row in self.slope
                if (float(row['slope']) > float(row['angle_of_friction'])) == above]

    def swing_table(self):
        rows = []
        for row in self.swing:
            value = {name: float(row[name]) for name in row if name != 'preset'}
            rows.append([row['preset'], f"{value['theory_period']:.3f}", f"{value['period']:.3f}",
                         misfit(f"{value['period_with_moved_air']:.3f}", value['period'],
                                value['period_with_moved_air']),
                         f"{value['theory_rate']:.2f}", misfit(f"{value['rate']:.2f}", value['rate'],
                                                               value['theory_rate']),
                         f"{value['rate_without_air'] + 0.0:.2g}".replace('-', '−')])
        return markdown_table(['preset', 'period by theory [s]', 'simulated [s]',
                               'with the air that moves along [s]', 'rate by theory [1/(m s)]',
                               'simulated', 'without air'], rows)

    def swing_ratio(self, simulated, theory):
        """Largest relative difference of two columns."""
        return max(abs(float(row[simulated]) / float(row[theory]) - 1.0) for row in self.swing)

    # ---- tears

    def tear_table(self):
        angles = sorted({float(row['angle']) for row in self.tear})
        rows = []
        for particles in sorted({int(row['particles']) for row in self.tear}):
            cells = []
            for angle in angles:
                of = [row for row in self.tear
                      if int(row['particles']) == particles and float(row['angle']) == angle]
                ratio = float(of[0]['force_over_half_energy'])
                cells.append(misfit(f'{ratio:.3f}', ratio, 1.0, 0.05))
            rows.append([f'{particles} x {particles}', f'{240.0 / (particles - 1):.2f}'] + cells)
        return markdown_table(['particles', 'cell [mm]'] + [f'{angle:g}°' for angle in angles], rows)

    def farthest_tear(self):
        return max(abs(float(row['force_over_half_energy']) - 1.0) for row in self.tear)

    def strengths(self, particles=None, notch=None):
        """Strengths [N] of notched strips, by the other of the two, ascending."""
        of = [row for row in self.notch
              if (particles is None or int(row['particles']) == particles)
              and (notch is None or float(row['notch']) == notch)]
        of.sort(key=lambda row: (int(row['particles']), float(row['notch'])))
        return [float(row['strength']) for row in of]

    def refinements(self, notch):
        """Relative changes of the strength from each size of cells to the next."""
        values = self.strengths(notch=notch)
        return [abs(fine / coarse - 1.0) for coarse, fine in zip(values, values[1:])]

    def notch_table(self):
        rows = sorted(self.notch, key=lambda row: (float(row['notch']), int(row['particles'])))
        shortest = min(rows, key=lambda row: float(row['notch']))
        scale = float(shortest['strength']) * math.sqrt(float(shortest['notch']))
        return markdown_table(
            ['notch [mm]', 'particles across', 'cell [mm]', 'strength [N]',
             'strength x root of the notch, over that of the shortest'],
            [[f"{1e3 * float(row['notch']):g}", row['particles'],
              f"{800.0 / (int(row['particles']) - 1):.1f}", f"{float(row['strength']):.1f}",
              f"{float(row['strength']) * math.sqrt(float(row['notch'])) / scale:.3f}"]
             for row in rows])
