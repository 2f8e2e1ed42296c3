"""What tools/bench prints of its result."""

ERRORS = {'frames': 'frames', 'ate_se3_m': 'ATE m', 'ate_se3_pct': 'ATE %',
          'scale_error_pct': 'scale error %', 'rpe_t_pct': 'RPE %',
          'rpe_r_deg_per_m': 'RPE deg/m'}  # of rigmap's evaluation -> heading
BESIDE_A_PRISM = {'frames': 'frames', 'rms_se2_m': 'horizontal RMS m', 'rms_se2_pct': 'RMS %',
                  'scale_truth_over_est': 'scale', 'truth_path_m': 'of m'}


def cell(number, pattern='{:.3f}'):
    return '-' if number is None else pattern.format(number)


def print_table(heading, rows):
    widths = [max(len(row[i]) for row in [heading, *rows]) for i in range(len(heading))]
    for row in [heading, *rows]:
        print(row[0].ljust(widths[0]),
              *(text.rjust(width) for text, width in zip(row[1:], widths[1:])), sep='  ')
    print()


def cost_row(name, rigmap, stock, pairs):
    """Stage, then wall, CPU and memory of both; of rigmap's stages nobody knows the CPU time."""
    row = [name]
    for side in (rigmap, stock):
        row += [cell(side[key] / pairs if key in side else None) for key in ('wall_s', 'cpu_s')]
        row.append(cell(side.get('peak_rss_mb'), '{:.0f}'))
    return row


def print_costs(result):
    print(', '.join(f'{program} {version}' for program, version in result['versions'].items()))
    print(f"{result['pairs']} pairs, {result['threads']} threads, load average "
          f"{result['load_before']:.1f} before; seconds a pair, peak megabytes"
          + (', rigmap with dense and fusion' if result['dense'] else ''))
    ours, theirs = ({stage['name']: stage for stage in result[side].get('stages', [])}
                    for side in ('rigmap', 'stock'))
    rows = [cost_row(name, ours.get(name, {}), theirs.get(name, {}), result['pairs'])
            for name in ours | theirs]
    stock_total = result['stock'] if result['stock'].get('complete') else {}
    rows.append(cost_row('total', result['rigmap'], stock_total, result['pairs']))
    print_table(['stage', 'rigmap wall', 'cpu', 'MB', 'stock wall', 'cpu', 'MB'], rows)
    if result['stock_by_rigmap']:
        print('stock / rigmap: {wall:.1f} in wall time, {cpu:.1f} in CPU time\n'.format(
            **result['stock_by_rigmap']))


def print_findings(result):
    if result['errors']:
        tracked = any('rms_se2_m' in errors for errors in result['errors'].values())
        columns = BESIDE_A_PRISM if tracked else ERRORS
        print_table(['trajectory', *columns.values()],
                    [[name, *(cell(errors.get(key), '{:g}') for key in columns)]
                     for name, errors in result['errors'].items()])
    for side in ('rigmap', 'stock'):
        spread = result[side].get('relative_spread')
        if spread is not None:
            print(f'left-right spread of the {side} model: {100 * spread:.3f} %')
    if 'models' in result['stock']:
        print('stock models: {models}; {registered_images} of {images} images in the largest'
              .format(**result['stock']))
    if result['rigmap'].get('reason'):
        print(f"rigmap: {result['rigmap']['status']}: {result['rigmap']['reason']}")
