fn main() {
    let path = std::env::args().nth(1).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let (chart, diagnostics) = aseme::statechart_of(&yase::Source::new(path, text));
    for d in diagnostics { eprintln!("{d}"); }
    if let Some(out) = std::env::args().nth(2) { std::fs::write(out, aseme::to_svg(&chart)).unwrap(); }
    else { println!("{}", aseme::to_text(&chart)); }
}
