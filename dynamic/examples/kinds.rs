use coadjoint_dynamic::Model;
fn main() {
    for f in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&f).unwrap();
        let model = Model::from_text(&text).unwrap();
        let step = &model.definition().steps[0];
        step.functions.march(None);
    }
}
