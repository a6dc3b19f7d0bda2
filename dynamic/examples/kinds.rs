use coadjoint_dynamic::Model;
fn main() {
    for f in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&f).unwrap();
        let t = std::time::Instant::now();
        let model = Model::from_text(&text).unwrap();
        let derive = t.elapsed().as_secs_f64() * 1e3;
        for step in &model.definition().steps {
            let t = std::time::Instant::now();
            step.functions.march(None);
            let ms = t.elapsed().as_secs_f64() * 1e3;
            println!("{} {derive:.1} ms {:?} fp {} newton {} true {} domain {} U {} S {} frame {} compile {ms:.1} ms blocks {:?}", model.name(), step.schemes, step.has_fixed_point_update, step.is_newton, step.has_true_jacobian, step.has_domain, step.layout.unknown.len(), step.layout.state.len(), step.frame.len(), step.blocks);
        }
    }
}
